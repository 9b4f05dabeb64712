; encode(holder, buffer, offset = 0) -> the offset behind what was written; encode(object) of the class that word 9 of the context leads to, behind which
; lie what is called for it and what calls that; whatever else is left to the slow path.
define ptr @any_call(ptr %self, ptr %args, i64 %nargsf, ptr %names) noinline {
  %view = alloca [80 x i8], align 8
  %context = call ptr @context(ptr %self)
  %count = call i64 @positional(i64 %nargsf, ptr %names)
  switch i64 %count, label %slow [ i64 3, label %holder
                                   i64 2, label %holder
                                   i64 1, label %object ]
object:
  %others.at = getelementptr ptr, ptr %context, i64 9
  %others = load ptr, ptr %others.at
  %has.others = icmp ne ptr %others, null
  br i1 %has.others, label %compare, label %slow
compare:
  %object.value = load ptr, ptr %args
  %class.at = getelementptr i8, ptr %object.value, i64 8
  %class = load ptr, ptr %class.at
  %known = load ptr, ptr %others
  %is.known = icmp eq ptr %class, %known
  br i1 %is.known, label %hand.over, label %slow
hand.over:
  %callable.at = getelementptr ptr, ptr %others, i64 1
  %callable = load ptr, ptr %callable.at
  %caller.at = getelementptr ptr, ptr %others, i64 2
  %caller = load ptr, ptr %caller.at
  %handed = tail call ptr %caller(ptr %callable, ptr %args, i64 1, ptr null)
  ret ptr %handed
holder:
  %holder.object = load ptr, ptr %args
  %state = call ptr @state_of(ptr %context, ptr %holder.object)
  %mine = icmp ne ptr %state, null
  br i1 %mine, label %into, label %slow, !prof !0
into:
  %somewhere = icmp eq i64 %count, 3
  br i1 %somewhere, label %place, label %target
place:
  %offset.at = getelementptr ptr, ptr %args, i64 2
  %offset.object = load ptr, ptr %offset.at
  %asked = call i64 @PyLong_AsSsize_t(ptr %offset.object)
  %positive = icmp sge i64 %asked, 0
  br i1 %positive, label %target, label %negative, !prof !0
negative:
  %error = call ptr @PyErr_Occurred()
  %clean = icmp eq ptr %error, null
  br i1 %clean, label %slow, label %raise
target:
  %offset = phi i64 [ 0, %into ], [ %asked, %place ]
  %target.at = getelementptr ptr, ptr %args, i64 1
  %target.object = load ptr, ptr %target.at
  ; PyBUF_WRITABLE, PyBUF_FORMAT and PyBUF_ND
  %has = call i1 @open(ptr %target.object, ptr %view, i32 13)
  br i1 %has, label %opened, label %raise, !prof !0
opened:
  %room = load ptr, ptr %view
  %room.size.at = getelementptr i8, ptr %view, i64 16
  %room.size = load i64, ptr %room.size.at
  %inside = icmp sle i64 %offset, %room.size
  ; looked at here: to open a buffer may run any code
  %into.epoch = call i64 @epoch(ptr %state)
  %readable = call i1 @is_usable(ptr %state, i64 %into.epoch)
  %unshared = call i1 @registers_are_free(ptr %context)
  %into.usable = and i1 %readable, %unshared
  %plain = call i1 @holds_no_objects(ptr %target.object, ptr %view)
  %takes.bytes = and i1 %inside, %plain
  %fits = and i1 %takes.bytes, %into.usable
  br i1 %fits, label %prepare, label %close, !prof !0
prepare:
  call void @enter(ptr %state, i64 %into.epoch, i64 0)
  call void @lend_registers(ptr %context, ptr %state)
  call void @tell(ptr %context, ptr %state)
  %into.size = call i64 @prepare(ptr %state, i64 0)
  %prepared = icmp sge i64 %into.size, 0
  br i1 %prepared, label %fill, label %leave, !prof !0
fill:
  %filled.end = call i64 @kernel(ptr %room, i64 %offset, i64 %room.size, ptr %state, i64 0)
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
  %end.object = call ptr @number_of(ptr %context, i64 %end)
  ret ptr %end.object
failed:
  call void @untell(ptr %context, ptr %state)
  call void @note(i64 %end, ptr %state)
  br label %slow
slow:
  %answer = call ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %answer
raise:
  ret ptr null
}

; A number as an object, or null if there is no memory for one: the one of the call before, if that has ended at the same place. Messages of one type
; mostly do, and to make an object and take it apart again takes a fifth of a short call.
define internal ptr @number_of(ptr %context, i64 %number) alwaysinline {
  %last.at = getelementptr i64, ptr %context, i64 11
  %last = load i64, ptr %last.at
  %cell.at = getelementptr ptr, ptr %context, i64 10
  %cell = load ptr, ptr %cell.at
  %items.at = getelementptr i8, ptr %cell, i64 24
  %items = load ptr, ptr %items.at
  %before = load ptr, ptr %items
  %is.same = icmp eq i64 %last, %number
  br i1 %is.same, label %again, label %new, !prof !1
again:
  %same = call ptr @keep_any(ptr %before)
  ret ptr %same
new:
  %made = call ptr @PyLong_FromSsize_t(i64 %number)
  %there = icmp ne ptr %made, null
  br i1 %there, label %remember, label %done, !prof !0
remember:
  %kept = call ptr @keep_any(ptr %made)
  store ptr %kept, ptr %items
  store i64 %number, ptr %last.at
  call void @drop_any(ptr %before)
  br label %done
done:
  ret ptr %made
}
