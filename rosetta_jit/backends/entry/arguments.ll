; Of a call that has its kernel inside: its arguments stay where they are.
define internal void @leave_arguments(ptr %state, ptr %args) alwaysinline {
  ret void
}

define internal ptr @arguments_behind(ptr %state, ptr %args) alwaysinline {
  ret ptr %args
}

define internal ptr @message_behind(ptr %state, ptr %message) alwaysinline {
  ret ptr %message
}
