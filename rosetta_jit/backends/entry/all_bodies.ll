; The usual call calls the whole kernel, which answers for every message.
define internal i64 @usual(ptr %data, i64 %size, ptr %state) alwaysinline {
  %result = call range(i64 -9223372036854775807, -9223372036854775808) i64 @kernel(ptr %data, i64 0, i64 %size, ptr %state, i64 0) #0
  ret i64 %result
}

; The state behind the kernel's call, across which no register is saved for it.
define internal ptr @state_behind(ptr %context, ptr %state) alwaysinline {
  %same = load ptr, ptr %context
  ret ptr %same
}

define internal ptr @call_of_next(ptr %self, ptr %args) alwaysinline {
  ret ptr null
}
