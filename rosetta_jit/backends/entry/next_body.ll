declare i64 @kernel.next(ptr, i64, i64, ptr, i64)

; The rest of a call whose message the first body has left: all that was asked before holds, and as the kernel calls nothing of its host, there is
; nothing to `leave`.
define ptr @call_of_next(ptr %self, ptr %args) {
  %message = load ptr, ptr %args
  %context = call ptr @context(ptr %self)
  %state = load ptr, ptr %context
  %data = getelementptr i8, ptr %message, i64 32
  %size.at = getelementptr i8, ptr %message, i64 16
  %size = load i64, ptr %size.at
  %result = call i64 @kernel.next(ptr %data, i64 0, i64 %size, ptr %state, i64 0)
  %answer = tail call ptr @finish(ptr %context, ptr %state, ptr %args, ptr %message, i64 %result)
  ret ptr %answer
}
