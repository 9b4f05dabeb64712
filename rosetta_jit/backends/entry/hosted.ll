; The kernels call functions that may run Python, and let other threads run: until they return, the epoch (`kernel.state.EPOCH`) says that the lanes
; are in use. `%changes` is 1 where the run changes the lanes, else 0.
define internal void @enter(ptr %state, i64 %epoch, i64 %changes) alwaysinline {
  %at = getelementptr i64, ptr %state, i64 1
  %in.use = xor i64 %epoch, -1
  store i64 %in.use, ptr %at
  ret void
}

define internal void @leave(ptr %state, i64 %epoch, i64 %changes) alwaysinline {
  %at = getelementptr i64, ptr %state, i64 1
  %after = add i64 %epoch, %changes
  store i64 %after, ptr %at
  ret void
}
