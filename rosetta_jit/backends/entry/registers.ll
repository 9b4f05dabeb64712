; The kernels keep values from one message to the next, in the registers of their program (`kernel.nodes.Register`). Word 7 of the context is their
; address (`runtime.callable.REGISTERS`): COUNT words, and as many behind them for what they were before a message. The word in front of them is
; not 0 while a call uses them that does not have the interpreter lock all the time: then entries leave a message to the slow path, which refuses.

define internal i1 @registers_are_free(ptr %context) alwaysinline {
  %registers.at = getelementptr ptr, ptr %context, i64 7
  %registers = load ptr, ptr %registers.at
  %taken.at = getelementptr i64, ptr %registers, i64 -1
  %taken = load i64, ptr %taken.at
  %free = icmp eq i64 %taken, 0
  ret i1 %free
}

; Let kernels find the registers: their address goes into the state (`kernel.state.REGISTERS`).
define internal void @lend_registers(ptr %context, ptr %state) alwaysinline {
  %registers.at = getelementptr ptr, ptr %context, i64 7
  %registers = load ptr, ptr %registers.at
  %lent.at = getelementptr ptr, ptr %state, i64 16
  store ptr %registers, ptr %lent.at
  ret void
}

; Before a message that can still fail when a kernel has changed the registers.
define internal void @save_registers(ptr %state) alwaysinline {
  %lent.at = getelementptr ptr, ptr %state, i64 16
  %registers = load ptr, ptr %lent.at
  %saved = getelementptr i64, ptr %registers, i64 COUNT
  call void @move_registers(ptr %saved, ptr %registers)
  ret void
}

; Behind such a message, where it has failed.
define internal void @restore_registers(ptr %state) alwaysinline {
  %lent.at = getelementptr ptr, ptr %state, i64 16
  %registers = load ptr, ptr %lent.at
  %saved = getelementptr i64, ptr %registers, i64 COUNT
  call void @move_registers(ptr %registers, ptr %saved)
  ret void
}

define internal void @move_registers(ptr %target, ptr %source) alwaysinline {
  br label %each
each:
  %index = phi i64 [ 0, %0 ], [ %next, %each ]
  %from = getelementptr i64, ptr %source, i64 %index
  %value = load volatile i64, ptr %from
  %to = getelementptr i64, ptr %target, i64 %index
  store i64 %value, ptr %to
  %next = add i64 %index, 1
  %more = icmp slt i64 %next, COUNT
  br i1 %more, label %each, label %done
done:
  ret void
}
