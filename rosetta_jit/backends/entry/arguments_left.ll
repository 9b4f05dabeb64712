; Of a call that calls its kernel: its arguments lie in the state meanwhile, in word 9, which says nothing before a kernel has failed. In registers they
; would have to be saved for the caller. Lanes whose kernel may run other code are in use until it returns (`hosted.ll`), so that nobody writes there.
define internal void @leave_arguments(ptr %state, ptr %args) alwaysinline {
  %at = getelementptr i64, ptr %state, i64 9
  store ptr %args, ptr %at
  ret void
}

define internal ptr @arguments_behind(ptr %state, ptr %args) alwaysinline {
  %at = getelementptr i64, ptr %state, i64 9
  %left = load ptr, ptr %at
  ret ptr %left
}

define internal ptr @message_behind(ptr %state, ptr %message) alwaysinline {
  %left = call ptr @arguments_behind(ptr %state, ptr null)
  %same = load ptr, ptr %left
  ret ptr %same
}
