; decode(message) -> the program's own holder; decode(message, holder) -> that holder. A message is any bytes-like object.
;
; A bytes object alone is decoded here, by a kernel that is part of this function if it is short: then its row is known to be 0, and its first byte
; to be the message's. Else little is kept across its call, so that few registers are saved for the caller. The program's own holder belongs to
; one thread, and the slow path has one for each other thread.
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
  %usable = and i1 %mine, %free
  br i1 %usable, label %decode, label %other, !prof !1
decode:
  %data = getelementptr i8, ptr %message, i64 32
  %size.at = getelementptr i8, ptr %message, i64 16
  %size = load i64, ptr %size.at
  call void @enter(ptr %state, i64 %epoch, i64 1)
  call void @tell(ptr %context, ptr %state)
  %result = call i64 @kernel(ptr %data, i64 0, i64 %size, ptr %state, i64 0) #0
  call void @leave(ptr %state, i64 %epoch, i64 1)
  %good = icmp sge i64 %result, 0
  br i1 %good, label %return, label %failed, !prof !0
return:
  %good.state = load ptr, ptr %context
  store i64 1, ptr %good.state
  %holder.at = getelementptr ptr, ptr %context, i64 1
  %holder = load ptr, ptr %holder.at
  call void @keep(ptr %holder)
  ret ptr %holder
failed:
  %bad.state = load ptr, ptr %context
  store i64 0, ptr %bad.state
  call void @untell(ptr %context, ptr %bad.state)
  call void @note(i64 %result, ptr %bad.state)
  %answer = tail call ptr @slow(ptr %context, ptr %args, i64 1, ptr null)
  ret ptr %answer
other:
  %found = musttail call ptr @any_call(ptr %self, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %found
}

define internal ptr @any_call(ptr %self, ptr %args, i64 %nargsf, ptr %names) noinline {
  %view = alloca [80 x i8], align 8
  %context = call ptr @context(ptr %self)
  %count = call i64 @positional(i64 %nargsf, ptr %names)
  switch i64 %count, label %slow [ i64 1, label %own
                                   i64 2, label %other ]
own:
  %own.state = load ptr, ptr %context
  %own.holder.at = getelementptr ptr, ptr %context, i64 1
  %own.holder = load ptr, ptr %own.holder.at
  %own.thread = call i1 @is_mine(ptr %context)
  br i1 %own.thread, label %message, label %slow, !prof !0
other:
  %other.holder.at = getelementptr ptr, ptr %args, i64 1
  %other.holder = load ptr, ptr %other.holder.at
  %other.state = call ptr @state_of(ptr %context, ptr %other.holder)
  %mine = icmp ne ptr %other.state, null
  br i1 %mine, label %message, label %slow, !prof !0
message:
  %state = phi ptr [ %own.state, %own ], [ %other.state, %other ]
  %holder = phi ptr [ %own.holder, %own ], [ %other.holder, %other ]
  %message.object = load ptr, ptr %args
  %type.at = getelementptr i8, ptr %message.object, i64 8
  %type = load ptr, ptr %type.at
  %is_bytes = icmp eq ptr %type, @PyBytes_Type
  br i1 %is_bytes, label %bytes, label %buffer, !prof !1
bytes:
  %size.at = getelementptr i8, ptr %message.object, i64 16
  %size = load i64, ptr %size.at
  %data = getelementptr i8, ptr %message.object, i64 32
  br label %decode
buffer:
  %has = call i1 @open(ptr %message.object, ptr %view, i32 0)
  br i1 %has, label %viewed, label %raise, !prof !0
viewed:
  %view.data = load ptr, ptr %view
  %view.size.at = getelementptr i8, ptr %view, i64 16
  %view.size = load i64, ptr %view.size.at
  br label %decode
decode:
  %start = phi ptr [ %data, %bytes ], [ %view.data, %viewed ]
  %end = phi i64 [ %size, %bytes ], [ %view.size, %viewed ]
  ; looked at here: to open a buffer may run any code
  %epoch = call i64 @epoch(ptr %state)
  %free = icmp sge i64 %epoch, 0
  br i1 %free, label %run, label %finish, !prof !0
run:
  call void @enter(ptr %state, i64 %epoch, i64 1)
  call void @tell(ptr %context, ptr %state)
  %result = call i64 @kernel(ptr %start, i64 0, i64 %end, ptr %state, i64 0)
  call void @leave(ptr %state, i64 %epoch, i64 1)
  %good = icmp sge i64 %result, 0
  %valid = zext i1 %good to i64
  store i64 %valid, ptr %state
  br i1 %good, label %finish, label %failed, !prof !0
failed:
  call void @untell(ptr %context, ptr %state)
  call void @note(i64 %result, ptr %state)
  br label %finish
finish:
  %done = phi i1 [ false, %decode ], [ true, %run ], [ false, %failed ]
  br i1 %is_bytes, label %judge, label %release, !prof !1
release:
  call void @close(ptr %message.object, ptr %view)
  br label %judge
judge:
  br i1 %done, label %return, label %slow, !prof !0
return:
  call void @keep(ptr %holder)
  ret ptr %holder
slow:
  %answer = call ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %answer
raise:
  ret ptr null
}

; Nothing precedes decoding.
define internal i64 @prepare(ptr %state, i64 %row) alwaysinline {
  ret i64 0
}
