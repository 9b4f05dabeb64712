; encode(holder) -> bytes, of a holder that is of exactly the program's type and valid. The size kernel gives the exact size; an encoder that ends
; elsewhere has failed. Whatever else is called is in `any_encode.ll`.
define ptr @call(ptr %self, ptr %args, i64 %nargsf, ptr %names) {
  %alone = call i1 @is_alone(i64 %nargsf, ptr %names)
  br i1 %alone, label %holder, label %other, !prof !1
holder:
  %context = call ptr @context(ptr %self)
  %holder.object = load ptr, ptr %args
  %is_ours = call i1 @is_of_type(ptr %context, ptr %holder.object)
  br i1 %is_ours, label %look, label %other, !prof !0
look:
  %state = call ptr @state_in(ptr %holder.object)
  %there = icmp ne ptr %state, null
  br i1 %there, label %check, label %other, !prof !0
check:
  %epoch = call i64 @epoch(ptr %state)
  %readable = call i1 @is_usable(ptr %state, i64 %epoch)
  %unshared = call i1 @registers_are_free(ptr %context)
  %usable = and i1 %readable, %unshared
  br i1 %usable, label %measure, label %other, !prof !0
measure:
  call void @enter(ptr %state, i64 %epoch, i64 0)
  call void @lend_registers(ptr %context, ptr %state)
  call void @tell(ptr %context, ptr %state)
  %size = call i64 @measure(ptr %state, i64 0)
  %measured = icmp sge i64 %size, 0
  br i1 %measured, label %allocate, label %stop, !prof !0
allocate:
  %bytes = call ptr @new_bytes(i64 %size)
  %allocated = icmp ne ptr %bytes, null
  br i1 %allocated, label %write, label %unallocated, !prof !0
unallocated:
  call void @leave(ptr %state, i64 %epoch, i64 0)
  call void @untell(ptr %context, ptr %state)
  ret ptr null
write:
  %data = getelementptr i8, ptr %bytes, i64 32
  %written = call i64 @kernel(ptr %data, i64 0, i64 %size, ptr %state, i64 0) #0
  ; asked of the bytes: then the size need not outlive the kernel's call
  %room.at = getelementptr i8, ptr %bytes, i64 16
  %room = load i64, ptr %room.at
  %exact = icmp eq i64 %written, %room
  br i1 %exact, label %return, label %drop, !prof !0
return:
  call void @leave(ptr %state, i64 %epoch, i64 0)
  ret ptr %bytes
drop:
  call void @Py_DecRef(ptr %bytes)
  br label %stop
stop:
  %failure = phi i64 [ %size, %measure ], [ %written, %drop ]
  call void @leave(ptr %state, i64 %epoch, i64 0)
  call void @untell(ptr %context, ptr %state)
  call void @note(i64 %failure, ptr %state)
  %answer = call ptr @slow(ptr %context, ptr %args, i64 1, ptr null)
  ret ptr %answer
other:
  %found = musttail call ptr @any_call(ptr %self, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %found
}
