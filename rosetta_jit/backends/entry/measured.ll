; The size of a message, or the size kernel's failure.
define internal i64 @measure(ptr %state, i64 %row) alwaysinline {
  %size = call i64 @size(ptr null, i64 0, i64 1152921504606846976, ptr %state, i64 %row)
  ret i64 %size
}
