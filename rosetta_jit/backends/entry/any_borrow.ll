; Whatever is not the common call of a borrowing decoder: a message that has a buffer, but is no bytes object. A memoryview is made first and the kernel
; reads through it: an exporter need not give out the same memory twice. Another holder has a source cell of its own: the slow path.
define ptr @any_call(ptr %self, ptr %args, i64 %nargsf, ptr %names) noinline {
  %view = alloca [80 x i8], align 8
  %context = call ptr @context(ptr %self)
  %state = load ptr, ptr %context
  %count = call i64 @positional(i64 %nargsf, ptr %names)
  %alone = icmp eq i64 %count, 1
  %mine = call i1 @is_mine(ptr %context)
  %own = and i1 %alone, %mine
  br i1 %own, label %message, label %slow, !prof !0
message:
  %message.object = load ptr, ptr %args
  %type.at = getelementptr i8, ptr %message.object, i64 8
  %type = load ptr, ptr %type.at
  %is_bytes = icmp eq ptr %type, @PyBytes_Type
  br i1 %is_bytes, label %slow, label %buffer
buffer:
  %source = call ptr @PyMemoryView_FromObject(ptr %message.object)
  %has = icmp ne ptr %source, null
  br i1 %has, label %open, label %raise, !prof !0
open:
  %got = call i32 @open_message(ptr %source, ptr %view)
  switch i32 %got, label %drop [ i32 1, label %viewed
                                 i32 0, label %abandon ], !prof !2
viewed:
  %start = load ptr, ptr %view
  %end.at = getelementptr i8, ptr %view, i64 16
  %end = load i64, ptr %end.at
  ; looked at here: to open a buffer may run any code
  %epoch = call i64 @epoch(ptr %state)
  %unused = icmp sge i64 %epoch, 0
  %unshared = call i1 @registers_are_free(ptr %context)
  %free = and i1 %unused, %unshared
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
  call void @note(i64 %result, ptr %state)
  br label %finish
finish:
  %done = phi i1 [ false, %viewed ], [ true, %run ], [ false, %failed ]
  call void @PyBuffer_Release(ptr %view)
  br i1 %done, label %return, label %abandon, !prof !0
return:
  %holder.at = getelementptr ptr, ptr %context, i64 1
  %holder = load ptr, ptr %holder.at
  call void @keep(ptr %holder)
  call void @retain(ptr %context, ptr %source)
  call void @Py_DecRef(ptr %source)
  ret ptr %holder
abandon:
  call void @Py_DecRef(ptr %source)
  br label %slow
slow:
  %answer = call ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %answer
drop:
  call void @Py_DecRef(ptr %source)
  br label %raise
raise:
  ret ptr null
}
