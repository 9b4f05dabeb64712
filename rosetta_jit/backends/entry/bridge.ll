; bridge(message) -> bytes; bridge(message, buffer) -> how many bytes of the buffer were written. A message is any bytes-like object, a buffer any
; that can be written to. Three kernels: @kernel decodes into the bridge's own lanes, @size measures what @write is going to write from there.
;
; Nobody else knows these lanes, and who calls has the interpreter lock from begin to end: threads share them. Where a kernel may let it go
; (`hosted.ll`) the epoch says that they are in use, and the slow path takes others.
define ptr @call(ptr %self, ptr %args, i64 %nargsf, ptr %names) {
  %view = alloca [80 x i8], align 8
  %context = call ptr @context(ptr %self)
  %state = load ptr, ptr %context
  %count = call i64 @positional(i64 %nargsf, ptr %names)
  %alone = icmp eq i64 %count, 1
  br i1 %alone, label %look, label %more, !prof !0
look:
  %message = load ptr, ptr %args
  %type.at = getelementptr i8, ptr %message, i64 8
  %type = load ptr, ptr %type.at
  %is_bytes = icmp eq ptr %type, @PyBytes_Type
  br i1 %is_bytes, label %bytes, label %buffer, !prof !1
bytes:
  %bytes.size.at = getelementptr i8, ptr %message, i64 16
  %bytes.size = load i64, ptr %bytes.size.at
  %bytes.data = getelementptr i8, ptr %message, i64 32
  br label %check
buffer:
  %has = call i32 @open_message(ptr %message, ptr %view)
  switch i32 %has, label %raise [ i32 1, label %viewed
                                  i32 0, label %slow ], !prof !2
viewed:
  %view.data = load ptr, ptr %view
  %view.size.at = getelementptr i8, ptr %view, i64 16
  %view.size = load i64, ptr %view.size.at
  br label %check
check:
  %data = phi ptr [ %bytes.data, %bytes ], [ %view.data, %viewed ]
  %end = phi i64 [ %bytes.size, %bytes ], [ %view.size, %viewed ]
  ; looked at here: to open a buffer may run any code
  %epoch = call i64 @epoch(ptr %state)
  %unused = icmp sge i64 %epoch, 0
  %unshared = call i1 @registers_are_free(ptr %context)
  %free = and i1 %unused, %unshared
  br i1 %free, label %run, label %close, !prof !0
run:
  call void @enter(ptr %state, i64 %epoch, i64 1)
  call void @lend_registers(ptr %context, ptr %state)
  call void @save_registers(ptr %state)
  call void @tell(ptr %context, ptr %state)
  %size = call i64 @taken(ptr %data, i64 0, i64 %end, ptr %state)
  %measured = icmp sge i64 %size, 0
  br i1 %measured, label %allocate, label %stop, !prof !0
allocate:
  %made = call ptr @new_bytes(i64 %size)
  %allocated = icmp ne ptr %made, null
  br i1 %allocated, label %write, label %stop, !prof !0
write:
  %room = getelementptr i8, ptr %made, i64 32
  %written = call i64 @write(ptr %room, i64 0, i64 %size, ptr %state, i64 0) #2
  %exact = icmp eq i64 %written, %size
  br i1 %exact, label %leave, label %drop, !prof !0
drop:
  call void @Py_DecRef(ptr %made)
  br label %stop
stop:
  %unallocated = phi i1 [ false, %run ], [ true, %allocate ], [ false, %drop ]
  call void @restore_registers(ptr %state)
  call void @untell(ptr %context, ptr %state)
  br label %leave
leave:
  %result = phi ptr [ %made, %write ], [ null, %stop ]
  %out.of.memory = phi i1 [ false, %write ], [ %unallocated, %stop ]
  call void @leave(ptr %state, i64 %epoch, i64 1)
  br label %close
close:
  %answer = phi ptr [ null, %check ], [ %result, %leave ]
  %raised = phi i1 [ false, %check ], [ %out.of.memory, %leave ]
  br i1 %is_bytes, label %judge, label %release, !prof !1
release:
  call void @close(ptr %message, ptr %view)
  br label %judge
judge:
  %done = icmp ne ptr %answer, null
  %over = or i1 %done, %raised
  br i1 %over, label %return, label %slow, !prof !0
return:
  ret ptr %answer
more:
  %two = icmp eq i64 %count, 2
  br i1 %two, label %into, label %slow, !prof !0
into:
  %filled = musttail call ptr @into(ptr %self, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %filled
slow:
  %found = call ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %found
raise:
  ret ptr null
}

; bridge(message, buffer). Whatever goes wrong is found out again by the slow path, which says it.
define internal ptr @into(ptr %self, ptr %args, i64 %nargsf, ptr %names) noinline {
  %view = alloca [80 x i8], align 8
  %target.view = alloca [80 x i8], align 8
  %context = call ptr @context(ptr %self)
  %state = load ptr, ptr %context
  %message = load ptr, ptr %args
  %target.at = getelementptr ptr, ptr %args, i64 1
  %target = load ptr, ptr %target.at
  %has = call i32 @open_message(ptr %message, ptr %view)
  switch i32 %has, label %raise [ i32 1, label %opened
                                  i32 0, label %slow ], !prof !2
opened:
  ; PyBUF_WRITABLE, PyBUF_FORMAT and PyBUF_ND
  %takes = call i1 @open(ptr %target, ptr %target.view, i32 13)
  br i1 %takes, label %both, label %refused, !prof !0
refused:
  call void @close(ptr %message, ptr %view)
  ret ptr null
both:
  %data = load ptr, ptr %view
  %end.at = getelementptr i8, ptr %view, i64 16
  %end = load i64, ptr %end.at
  %room = load ptr, ptr %target.view
  %room.size.at = getelementptr i8, ptr %target.view, i64 16
  %room.size = load i64, ptr %room.size.at
  %data.end = getelementptr i8, ptr %data, i64 %end
  %room.end = getelementptr i8, ptr %room, i64 %room.size
  %before = icmp ule ptr %data.end, %room
  %behind = icmp ule ptr %room.end, %data
  %apart = or i1 %before, %behind
  ; looked at here: to open a buffer may run any code
  %epoch = call i64 @epoch(ptr %state)
  %unused = icmp sge i64 %epoch, 0
  %unshared = call i1 @registers_are_free(ptr %context)
  %free = and i1 %unused, %unshared
  %plain = call i1 @holds_no_objects(ptr %target, ptr %target.view)
  %takes.bytes = and i1 %apart, %plain
  %usable = and i1 %takes.bytes, %free
  br i1 %usable, label %run, label %close, !prof !0
run:
  call void @enter(ptr %state, i64 %epoch, i64 1)
  call void @lend_registers(ptr %context, ptr %state)
  call void @save_registers(ptr %state)
  call void @tell(ptr %context, ptr %state)
  %size = call i64 @taken(ptr %data, i64 0, i64 %end, ptr %state)
  %measured = icmp sge i64 %size, 0
  %small = icmp sle i64 %size, %room.size
  %fits = and i1 %measured, %small
  br i1 %fits, label %write, label %stop, !prof !0
write:
  %written = call i64 @write(ptr %room, i64 0, i64 %size, ptr %state, i64 0)
  %exact = icmp eq i64 %written, %size
  br i1 %exact, label %leave, label %stop, !prof !0
stop:
  call void @restore_registers(ptr %state)
  call void @untell(ptr %context, ptr %state)
  br label %leave
leave:
  %good = phi i1 [ true, %write ], [ false, %stop ]
  call void @leave(ptr %state, i64 %epoch, i64 1)
  br label %close
close:
  %done = phi i1 [ false, %both ], [ %good, %leave ]
  %length = phi i64 [ 0, %both ], [ %size, %leave ]
  call void @close(ptr %target, ptr %target.view)
  call void @close(ptr %message, ptr %view)
  br i1 %done, label %return, label %slow, !prof !0
return:
  %number = call ptr @PyLong_FromSsize_t(i64 %length)
  ret ptr %number
slow:
  %found = call ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %found
raise:
  ret ptr null
}

declare void @refer(ptr, ptr, i64)
declare i64 @write(ptr, i64, i64, ptr, i64)

; Decode a message and measure what it becomes: that size, or the failure of a kernel.
define internal i64 @taken(ptr %data, i64 %begin, i64 %end, ptr %state) alwaysinline {
  %result = call i64 @kernel(ptr %data, i64 %begin, i64 %end, ptr %state, i64 0) #0
  %good = icmp sge i64 %result, 0
  br i1 %good, label %measure, label %failed, !prof !0
measure:
  call void @refer(ptr %state, ptr %data, i64 %end)
  %size = call i64 @size(ptr null, i64 0, i64 1152921504606846976, ptr %state, i64 0) #1
  ret i64 %size
failed:
  ret i64 %result
}

; Many messages in one call, without the interpreter lock. Message i lies at begins[i] to ends[i], and is written to places[i] on,
; which is where places[i + 1] then says that it ends. Returns the first message that was not done: count, if all were. Then word 9 of the state
; (`kernel.state.RESULT`) has a kernel's failure, 0 where the message ends before it begins or leaves the buffer, or 1 where there is no room for what would be
; written. Each place is loaded once where it is checked and used, because another thread may write to it meanwhile.
define i64 @many(ptr %buffer, i64 %size, ptr %begins, ptr %ends, i64 %first, i64 %count, ptr %state, ptr %target, i64 %room, ptr %places) {
  %number.at = getelementptr i64, ptr %state, i64 13
  %start.at = getelementptr i64, ptr %places, i64 %first
  %start = load i64, ptr %start.at
  br label %head
head:
  %index = phi i64 [ %first, %0 ], [ %next, %done ]
  %place = phi i64 [ %start, %0 ], [ %after, %done ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %all
each:
  call void @save_registers(ptr %state)
  %begin.at = getelementptr i64, ptr %begins, i64 %index
  %begin = load volatile i64, ptr %begin.at
  %next = add nsw i64 %index, 1
  %end.at = getelementptr i64, ptr %ends, i64 %index
  %end = load volatile i64, ptr %end.at
  %positive = icmp sge i64 %begin, 0
  %ordered = icmp sle i64 %begin, %end
  %inside = icmp sle i64 %end, %size
  %known = and i1 %positive, %ordered
  %sound = and i1 %known, %inside
  br i1 %sound, label %take, label %broken, !prof !0
take:
  %taken = call i64 @taken(ptr %buffer, i64 %begin, i64 %end, ptr %state)
  %measured = icmp sge i64 %taken, 0
  br i1 %measured, label %fit, label %broken, !prof !0
fit:
  %left = sub i64 %room, %place
  %fits = icmp sle i64 %taken, %left
  %after = add i64 %place, %taken
  br i1 %fits, label %write, label %broken, !prof !0
write:
  %written = call i64 @write(ptr %target, i64 %place, i64 %after, ptr %state, i64 0)
  %exact = icmp eq i64 %written, %after
  br i1 %exact, label %done, label %broken, !prof !0
done:
  %place.at = getelementptr i64, ptr %places, i64 %next
  store i64 %after, ptr %place.at
  %number = load i64, ptr %number.at
  %number.next = add i64 %number, 1
  store i64 %number.next, ptr %number.at
  br label %head
all:
  ret i64 %index
broken:
  %why = phi i64 [ 0, %each ], [ %taken, %take ], [ 1, %fit ], [ %written, %write ]
  call void @restore_registers(ptr %state)
  call void @note(i64 %why, ptr %state)
  ret i64 %index
}
