; Whatever is not the common call of a decoder: a holder that is given, a message that is no bytes object.
define ptr @any_call(ptr %self, ptr %args, i64 %nargsf, ptr %names) noinline {
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
  %has = call i32 @open_message(ptr %message.object, ptr %view)
  switch i32 %has, label %raise [ i32 1, label %viewed
                                  i32 0, label %slow ], !prof !2
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
  %unused = icmp sge i64 %epoch, 0
  %unshared = call i1 @registers_are_free(ptr %context)
  %ready = call i1 @is_ready(ptr %state)
  %fit = and i1 %unused, %unshared
  %free = and i1 %fit, %ready
  br i1 %free, label %run, label %finish, !prof !0
run:
  call void @enter(ptr %state, i64 %epoch, i64 1)
  call void @lend_registers(ptr %context, ptr %state)
  call void @tell(ptr %context, ptr %state)
  %result = call i64 @kernel(ptr %start, i64 0, i64 %end, ptr %state, i64 0)
  call void @leave(ptr %state, i64 %epoch, i64 1)
  %good = icmp sge i64 %result, 0
  %valid = zext i1 %good to i64
  store i64 %valid, ptr %state
  br i1 %good, label %finish, label %failed, !prof !0
failed:
  call void @untell(ptr %context, ptr %state)
  call void @say_failed(ptr %context)
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
