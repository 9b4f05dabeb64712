; The kernels call no function that could run Python: an entry has the interpreter lock from begin to end, so that nobody uses the lanes between.
; Of a run that changes them (`%changes` is 1, else 0) the epoch (`kernel.state.EPOCH`) is counted.
define internal void @enter(ptr %state, i64 %epoch, i64 %changes) alwaysinline {
  %counts = icmp ne i64 %changes, 0
  br i1 %counts, label %count, label %done
count:
  %at = getelementptr i64, ptr %state, i64 1
  %after = add i64 %epoch, %changes
  store i64 %after, ptr %at
  br label %done
done:
  ret void
}

define internal void @leave(ptr %state, i64 %epoch, i64 %changes) alwaysinline {
  ret void
}
