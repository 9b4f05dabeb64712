; Whether a holder can be read as it is: valid, in order, and not in use.
define internal i1 @is_usable(ptr %state, i64 %epoch) alwaysinline {
  %validity = load i64, ptr %state
  %valid = icmp eq i64 %validity, 1
  %free = icmp sge i64 %epoch, 0
  %usable = and i1 %valid, %free
  ret i1 %usable
}
