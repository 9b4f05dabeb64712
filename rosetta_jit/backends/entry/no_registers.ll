; The kernels keep nothing from one message to the next.
define internal i1 @registers_are_free(ptr %context) alwaysinline {
  ret i1 true
}

define internal void @lend_registers(ptr %context, ptr %state) alwaysinline {
  ret void
}

define internal void @save_registers(ptr %state) alwaysinline {
  ret void
}

define internal void @restore_registers(ptr %state) alwaysinline {
  ret void
}
