; How messages begin: functions that Python calls (METH_FASTCALL: self, arguments, how many). Only code of ours calls them, with what they expect.

@_Py_NoneStruct = external global i8

; begin(arena, begin, addresses) -> where the state lies. The arena is a bytearray with room to spare for its alignment, `begin` how it begins, and
; `addresses` has pairs of a word of the state and what stands there: an offset into the arena.
define ptr @begin(ptr %module, ptr %arguments, i64 %given) {
  %arena = load ptr, ptr %arguments
  %begin = call ptr @pointer(ptr %arguments, i64 8)
  %addresses = call ptr @pointer(ptr %arguments, i64 16)
  %memory = call i64 @word(ptr %arena, i64 40)
  %above = add i64 %memory, 63
  %aligned = and i64 %above, -64
  %state = inttoptr i64 %aligned to ptr
  %size = call i64 @word(ptr %begin, i64 16)
  %from = getelementptr i8, ptr %begin, i64 32
  call void @llvm.memmove.p0.p0.i64(ptr %state, ptr %from, i64 %size, i1 false)
  %pairs.bytes = call i64 @word(ptr %addresses, i64 16)
  %pairs = getelementptr i8, ptr %addresses, i64 32
  br label %head
head:
  %at = phi i64 [ 0, %0 ], [ %next, %each ]
  %more = icmp slt i64 %at, %pairs.bytes
  br i1 %more, label %each, label %done
each:
  %next = add i64 %at, 16
  %second = add i64 %at, 8
  %word = call i64 @word(ptr %pairs, i64 %at)
  %offset = call i64 @word(ptr %pairs, i64 %second)
  %address = add i64 %aligned, %offset
  %place = shl i64 %word, 3
  call void @put(ptr %state, i64 %place, i64 %address)
  br label %head
done:
  %object = call ptr @PyLong_FromUnsignedLongLong(i64 %aligned)
  ret ptr %object
}

; bind(message, lanes, access, parent, entry, *words) -> whether the message was new; else nothing is done. The words are those from 16 on. Then
; make the views that the message has from the start.
define ptr @bind(ptr %module, ptr %arguments, i64 %given) {
  %message = load ptr, ptr %arguments
  %state = call i64 @word(ptr %message, i64 16)
  %is.new = icmp eq i64 %state, 0
  br i1 %is.new, label %begin, label %old
old:
  %no = call ptr @box_bool(i8 0)
  ret ptr %no
begin:
  %lanes = call ptr @pointer(ptr %arguments, i64 8)
  %access = call ptr @pointer(ptr %arguments, i64 16)
  %parent = call ptr @pointer(ptr %arguments, i64 24)
  %entry = call ptr @pointer(ptr %arguments, i64 32)
  call void @set_slot(ptr %message, i64 72, ptr %access)
  call void @set_slot(ptr %message, i64 80, ptr %entry)
  call void @set_slot(ptr %message, i64 88, ptr %lanes)
  call void @set_slot(ptr %message, i64 96, ptr %parent)
  br label %head
head:
  %number = phi i64 [ 0, %begin ], [ %next, %each ]
  %more = icmp slt i64 %number, 7
  br i1 %more, label %each, label %fill
each:
  %next = add i64 %number, 1
  %from.fifth = shl i64 %number, 3
  %argument.at = add i64 %from.fifth, 40
  %word.at = add i64 %from.fifth, 16
  %argument = call ptr @pointer(ptr %arguments, i64 %argument.at)
  %converted = call { i64, i1 } @unbox_signed(ptr %argument)
  %word = extractvalue { i64, i1 } %converted, 0
  call void @put(ptr %message, i64 %word.at, i64 %word)
  br label %head
fill:
  %full = call i32 @populate(ptr %message)
  %good = icmp eq i32 %full, 0
  br i1 %good, label %done, label %failed
done:
  %yes = call ptr @box_bool(i8 1)
  ret ptr %yes
failed:
  ret ptr null
}

define internal void @set_slot(ptr %message, i64 %offset, ptr %value) {
  %old = call ptr @pointer(ptr %message, i64 %offset)
  call void @Py_IncRef(ptr %value)
  call void @put_pointer(ptr %message, i64 %offset, ptr %value)
  call void @forget(ptr %old)
  ret void
}

; restart(state, fresh): let each lane have the rows of a new message, and those alone. For each lane `fresh` says where its words lie in the state, how
; many rows there are, and how many bytes of them follow; these are filled up to a multiple of eight.
define ptr @restart(ptr %module, ptr %arguments, i64 %given) {
  %address.object = load ptr, ptr %arguments
  %fresh = call ptr @pointer(ptr %arguments, i64 8)
  %converted = call { i64, i1 } @unbox_signed(ptr %address.object)
  %address = extractvalue { i64, i1 } %converted, 0
  %state = inttoptr i64 %address to ptr
  %size = call i64 @word(ptr %fresh, i64 16)
  %data = getelementptr i8, ptr %fresh, i64 32
  br label %head
head:
  %at = phi i64 [ 0, %0 ], [ %next, %each ]
  %more = icmp slt i64 %at, %size
  br i1 %more, label %each, label %done
each:
  %entry = getelementptr i8, ptr %data, i64 %at
  %lane.at = load i64, ptr %entry
  %rows = call i64 @word(ptr %entry, i64 8)
  %bytes = call i64 @word(ptr %entry, i64 16)
  %from = getelementptr i8, ptr %entry, i64 24
  %lane = getelementptr i8, ptr %state, i64 %lane.at
  %to = load ptr, ptr %lane
  call void @llvm.memmove.p0.p0.i64(ptr %to, ptr %from, i64 %bytes, i1 false)
  call void @put(ptr %lane, i64 16, i64 %rows)
  %behind = add i64 %at, 24
  %next = add i64 %behind, %bytes
  br label %head
done:
  call void @Py_IncRef(ptr @_Py_NoneStruct)
  ret ptr @_Py_NoneStruct
}
