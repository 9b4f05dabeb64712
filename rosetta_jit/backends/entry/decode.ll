; decode(message) -> the program's own holder; decode(message, holder) -> that holder. A message is any bytes-like object.
;
; A bytes object alone is decoded here, by a kernel that is part of this function if it is short: then its row is known to be 0, and its first byte
; to be the message's. Else little is kept across its call, so that few registers are saved for the caller. The program's own holder belongs to
; one thread, and the slow path has one for each other thread. What a borrowing decoder does besides is `retain`. Where the kernel's first body
; alone is part of this function, the message that it leaves to the next one is `call_of_next`'s (`next_body.ll`): a function that calls nothing
; but at its very end needs no stack.
define ptr @call(ptr %self, ptr %args, i64 %nargsf, ptr %names) {
  %alone = call i1 @is_alone(i64 %nargsf, ptr %names)
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
  %lent = and i1 %mine, %free
  %ready = call i1 @is_ready(ptr %state)
  %fit = and i1 %lent, %unshared
  %usable = and i1 %fit, %ready
  br i1 %usable, label %decode, label %other, !prof !1
decode:
  %data = getelementptr i8, ptr %message, i64 32
  %size.at = getelementptr i8, ptr %message, i64 16
  %size = load i64, ptr %size.at
  call void @enter(ptr %state, i64 %epoch, i64 1)
  call void @lend_registers(ptr %context, ptr %state)
  call void @tell(ptr %context, ptr %state)
  call void @leave_arguments(ptr %state, ptr %args)
  %result = call i64 @usual(ptr %data, i64 %size, ptr %state)
  %known = icmp ne i64 %result, -9223372036854775808
  br i1 %known, label %finish, label %ask, !prof !0
finish:
  call void @leave(ptr %state, i64 %epoch, i64 1)
  %state.now = call ptr @state_behind(ptr %context, ptr %state)
  %answer = tail call ptr @finish(ptr %context, ptr %state.now, ptr %args, ptr %message, i64 %result)
  ret ptr %answer
ask:
  %other.answer = tail call ptr @call_of_next(ptr %self, ptr %args)
  ret ptr %other.answer
other:
  %found = musttail call ptr @any_call(ptr %self, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %found
}
