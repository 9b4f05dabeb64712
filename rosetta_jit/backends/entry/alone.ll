; The kernel fills the whole holder, whatever it had before.
define internal i1 @is_ready(ptr %state) alwaysinline {
  ret i1 true
}

define internal void @say_failed(ptr %context) alwaysinline {
  ret void
}
