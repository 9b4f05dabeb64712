; The kernels ask for nothing that the host tells.
define internal void @tell(ptr %context, ptr %state) alwaysinline {
  ret void
}

define internal void @untell(ptr %context, ptr %state) alwaysinline {
  ret void
}
