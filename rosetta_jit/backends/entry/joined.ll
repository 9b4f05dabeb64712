; The kernel fills a part of the holder, whose other parts messages of other wires have filled (`kernel.ir.Kernel.kept`). The slow path knows which
; of them are broken, and has all messages until none is.
define internal i1 @is_ready(ptr %state) alwaysinline {
  %validity = load i64, ptr %state
  %ready = icmp eq i64 %validity, 1
  ret i1 %ready
}

; Tell the slow path that it was this kernel that failed (`runtime.callable.FAILED`).
define internal void @say_failed(ptr %context) alwaysinline {
  %failed.at = getelementptr i64, ptr %context, i64 8
  store i64 1, ptr %failed.at
  ret void
}
