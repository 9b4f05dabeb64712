; decode(message) -> the program's own holder, which may keep views into the message: item 0 of its source cell, a list, becomes the bytes object
; or a memoryview of whatever else has a buffer. The memoryview is made first and the kernel reads through it: an exporter need not
; give out the same memory twice. Another holder has a cell of its own: the slow path.
define ptr @call(ptr %self, ptr %args, i64 %nargsf, ptr %names) {
  %view = alloca [80 x i8], align 8
  %context = call ptr @context(ptr %self)
  %state = load ptr, ptr %context
  %count = call i64 @positional(i64 %nargsf, ptr %names)
  %alone = icmp eq i64 %count, 1
  %mine = call i1 @is_mine(ptr %context)
  %usual = and i1 %alone, %mine
  br i1 %usual, label %message, label %slow, !prof !0
message:
  %message.object = load ptr, ptr %args
  %type.at = getelementptr i8, ptr %message.object, i64 8
  %type = load ptr, ptr %type.at
  %is_bytes = icmp eq ptr %type, @PyBytes_Type
  br i1 %is_bytes, label %bytes, label %buffer, !prof !1
bytes:
  call void @keep_any(ptr %message.object)
  %size.at = getelementptr i8, ptr %message.object, i64 16
  %size = load i64, ptr %size.at
  %data = getelementptr i8, ptr %message.object, i64 32
  br label %decode
buffer:
  %memory = call ptr @PyMemoryView_FromObject(ptr %message.object)
  %has = icmp ne ptr %memory, null
  br i1 %has, label %open, label %raise, !prof !0
open:
  %got = call i32 @PyObject_GetBuffer(ptr %memory, ptr %view, i32 0)
  %flat = icmp eq i32 %got, 0
  br i1 %flat, label %viewed, label %drop, !prof !0
viewed:
  %view.data = load ptr, ptr %view
  %view.size.at = getelementptr i8, ptr %view, i64 16
  %view.size = load i64, ptr %view.size.at
  br label %decode
decode:
  %source = phi ptr [ %message.object, %bytes ], [ %memory, %viewed ]
  %start = phi ptr [ %data, %bytes ], [ %view.data, %viewed ]
  %end = phi i64 [ %size, %bytes ], [ %view.size, %viewed ]
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
  %done = phi i1 [ false, %decode ], [ true, %run ], [ false, %failed ]
  br i1 %is_bytes, label %judge, label %release, !prof !1
release:
  call void @PyBuffer_Release(ptr %view)
  br label %judge
judge:
  br i1 %done, label %return, label %abandon, !prof !0
return:
  %cell.at = getelementptr ptr, ptr %context, i64 3
  %cell = load ptr, ptr %cell.at
  %holder.at = getelementptr ptr, ptr %context, i64 1
  %holder = load ptr, ptr %holder.at
  call void @keep(ptr %holder)
  %items.at = getelementptr i8, ptr %cell, i64 24
  %items = load ptr, ptr %items.at
  %last = load ptr, ptr %items
  store ptr %source, ptr %items
  call void @drop_any(ptr %last)
  ret ptr %holder
abandon:
  call void @Py_DecRef(ptr %source)
  br label %slow
slow:
  %answer = call ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %answer
drop:
  call void @Py_DecRef(ptr %memory)
  br label %raise
raise:
  ret ptr null
}
