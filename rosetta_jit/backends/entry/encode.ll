; encode(holder) -> bytes; encode(holder, buffer, offset) -> the offset behind what was written. The holder must be of exactly the
; program's type and valid. The size kernel gives the exact size; an encoder that ends elsewhere has failed.
define ptr @call(ptr %self, ptr %args, i64 %nargsf, ptr %names) {
  %view = alloca [80 x i8], align 8
  %context = call ptr @context(ptr %self)
  %count = call i64 @positional(i64 %nargsf, ptr %names)
  %alone = icmp eq i64 %count, 1
  %three = icmp eq i64 %count, 3
  %usual = or i1 %alone, %three
  br i1 %usual, label %holder, label %slow, !prof !0
holder:
  %holder.object = load ptr, ptr %args
  %state = call ptr @state_of(ptr %context, ptr %holder.object)
  %mine = icmp ne ptr %state, null
  br i1 %mine, label %choose, label %slow, !prof !0
choose:
  br i1 %alone, label %check, label %into, !prof !1
check:
  %epoch = call i64 @epoch(ptr %state)
  %usable = call i1 @is_usable(ptr %state, i64 %epoch)
  br i1 %usable, label %measure, label %slow, !prof !0
measure:
  call void @enter(ptr %state, i64 %epoch, i64 0)
  call void @tell(ptr %context, ptr %state)
  %size = call i64 @prepare(ptr %state, i64 0)
  %measured = icmp sge i64 %size, 0
  br i1 %measured, label %allocate, label %stop, !prof !0
allocate:
  %bytes = call ptr @PyBytes_FromStringAndSize(ptr null, i64 %size)
  %allocated = icmp ne ptr %bytes, null
  br i1 %allocated, label %write, label %unallocated, !prof !0
unallocated:
  call void @leave(ptr %state, i64 %epoch, i64 0)
  call void @untell(ptr %context, ptr %state)
  ret ptr null
write:
  %data = getelementptr i8, ptr %bytes, i64 32
  %written = call i64 @kernel(ptr %data, i64 0, i64 %size, ptr %state, i64 0) #0
  %exact = icmp eq i64 %written, %size
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
  br label %failed

into:
  %offset.at = getelementptr ptr, ptr %args, i64 2
  %offset.object = load ptr, ptr %offset.at
  %offset = call i64 @PyLong_AsSsize_t(ptr %offset.object)
  %positive = icmp sge i64 %offset, 0
  br i1 %positive, label %target, label %negative, !prof !0
negative:
  %error = call ptr @PyErr_Occurred()
  %clean = icmp eq ptr %error, null
  br i1 %clean, label %slow, label %raise
target:
  %target.at = getelementptr ptr, ptr %args, i64 1
  %target.object = load ptr, ptr %target.at
  ; PyBUF_WRITABLE
  %has = call i1 @open(ptr %target.object, ptr %view, i32 1)
  br i1 %has, label %opened, label %raise, !prof !0
opened:
  %room = load ptr, ptr %view
  %room.size.at = getelementptr i8, ptr %view, i64 16
  %room.size = load i64, ptr %room.size.at
  %inside = icmp sle i64 %offset, %room.size
  ; looked at here: to open a buffer may run any code
  %into.epoch = call i64 @epoch(ptr %state)
  %into.usable = call i1 @is_usable(ptr %state, i64 %into.epoch)
  %fits = and i1 %inside, %into.usable
  br i1 %fits, label %prepare, label %close, !prof !0
prepare:
  ; though the size is not asked for: the kernel looks up the lengths of nested messages that measuring leaves in the scratch lane
  call void @enter(ptr %state, i64 %into.epoch, i64 0)
  call void @tell(ptr %context, ptr %state)
  %into.size = call i64 @prepare(ptr %state, i64 0)
  %prepared = icmp sge i64 %into.size, 0
  br i1 %prepared, label %fill, label %leave, !prof !0
fill:
  %filled.end = call i64 @kernel(ptr %room, i64 %offset, i64 %room.size, ptr %state, i64 0) #0
  br label %leave
leave:
  %left = phi i64 [ %into.size, %prepare ], [ %filled.end, %fill ]
  call void @leave(ptr %state, i64 %into.epoch, i64 0)
  br label %close
close:
  %end = phi i64 [ 0, %opened ], [ %left, %leave ]
  call void @close(ptr %target.object, ptr %view)
  br i1 %fits, label %judge, label %slow, !prof !0
judge:
  %filled = icmp sge i64 %end, 0
  br i1 %filled, label %position, label %failed, !prof !0
position:
  %end.object = call ptr @PyLong_FromSsize_t(i64 %end)
  ret ptr %end.object

failed:
  %result = phi i64 [ %failure, %stop ], [ %end, %judge ]
  call void @untell(ptr %context, ptr %state)
  call void @note(i64 %result, ptr %state)
  br label %slow
slow:
  %answer = call ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %answer
raise:
  ret ptr null
}

; Whether a holder can be read as it is: valid, in order, and not in use.
define internal i1 @is_usable(ptr %state, i64 %epoch) alwaysinline {
  %validity = load i64, ptr %state
  %valid = icmp eq i64 %validity, 1
  %free = icmp sge i64 %epoch, 0
  %usable = and i1 %valid, %free
  ret i1 %usable
}

; The size of a message, or the size kernel's failure.
define internal i64 @prepare(ptr %state, i64 %row) alwaysinline {
  %size = call i64 @size(ptr null, i64 0, i64 1152921504606846976, ptr %state, i64 %row)
  ret i64 %size
}

; Where messages first to count - 1 end when they are written one behind the other from offsets[first]: fills offsets[first + 1] to offsets[count].
; Returns like @many.
define i64 @sizes(ptr %offsets, i64 %first, i64 %count, ptr %state) {
  br label %head
head:
  %index = phi i64 [ %first, %0 ], [ %next, %advance ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %result = call i64 @prepare(ptr %state, i64 %index)
  %good = icmp sge i64 %result, 0
  br i1 %good, label %place, label %broken, !prof !0
place:
  %begin.at = getelementptr i64, ptr %offsets, i64 %index
  %begin = load i64, ptr %begin.at
  %end = add i64 %begin, %result
  %sound = icmp sge i64 %end, %begin
  br i1 %sound, label %advance, label %broken, !prof !0
advance:
  %next = add nsw i64 %index, 1
  %end.at = getelementptr i64, ptr %offsets, i64 %next
  store i64 %end, ptr %end.at
  br label %head
done:
  ret i64 %index
broken:
  %why = phi i64 [ %result, %each ], [ 0, %place ]
  call void @note(i64 %why, ptr %state)
  ret i64 %index
}
