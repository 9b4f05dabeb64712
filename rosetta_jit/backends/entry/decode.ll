; decode(message) -> the program's own holder; decode(message, holder) -> that holder. A message is any bytes-like object.
;
; A bytes object alone is decoded here, by a kernel that is part of this function if it is short: then its row is known to be 0, and its first byte
; to be the message's. Else little is kept across its call, so that few registers are saved for the caller. The program's own holder belongs to
; one thread, and the slow path has one for each other thread. What a borrowing decoder does besides is `retain`.
declare ptr @any_call(ptr, ptr, i64, ptr)

define ptr @call(ptr %self, ptr %args, i64 %nargsf, ptr %names) {
  %count = call i64 @positional(i64 %nargsf, ptr %names)
  %alone = icmp eq i64 %count, 1
  br i1 %alone, label %look, label %other, !prof !1
look:
  %message = load ptr, ptr %args
  %type.at = getelementptr i8, ptr %message, i64 8
  %type = load ptr, ptr %type.at
  %is_bytes = icmp eq ptr %type, @PyBytes_Type
  br i1 %is_bytes, label %bytes, label %other, !prof !1
bytes:
  %context = call ptr @context(ptr %self)
  %state = load ptr, ptr %context
  %mine = call i1 @is_mine(ptr %context)
  %epoch = call i64 @epoch(ptr %state)
  %free = icmp sge i64 %epoch, 0
  %unshared = call i1 @registers_are_free(ptr %context)
  %known = and i1 %mine, %free
  %ready = call i1 @is_ready(ptr %state)
  %fit = and i1 %known, %unshared
  %usable = and i1 %fit, %ready
  br i1 %usable, label %decode, label %other, !prof !1
decode:
  %data = getelementptr i8, ptr %message, i64 32
  %size.at = getelementptr i8, ptr %message, i64 16
  %size = load i64, ptr %size.at
  call void @enter(ptr %state, i64 %epoch, i64 1)
  call void @lend_registers(ptr %context, ptr %state)
  call void @tell(ptr %context, ptr %state)
  %result = call i64 @kernel(ptr %data, i64 0, i64 %size, ptr %state, i64 0) #0
  call void @leave(ptr %state, i64 %epoch, i64 1)
  %good = icmp sge i64 %result, 0
  br i1 %good, label %return, label %failed, !prof !0
return:
  %good.state = load ptr, ptr %context
  store i64 1, ptr %good.state
  call void @retain(ptr %context, ptr %message)
  %holder.at = getelementptr ptr, ptr %context, i64 1
  %holder = load ptr, ptr %holder.at
  call void @keep(ptr %holder)
  ret ptr %holder
failed:
  %bad.state = load ptr, ptr %context
  store i64 0, ptr %bad.state
  call void @untell(ptr %context, ptr %bad.state)
  call void @say_failed(ptr %context)
  call void @note(i64 %result, ptr %bad.state)
  %answer = tail call ptr @slow(ptr %context, ptr %args, i64 1, ptr null)
  ret ptr %answer
other:
  %found = musttail call ptr @any_call(ptr %self, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %found
}
