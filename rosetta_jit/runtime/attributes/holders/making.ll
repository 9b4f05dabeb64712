; How messages begin: functions that Python calls (METH_FASTCALL: self, arguments, how many). Only code of ours calls them, with what they expect.

@_Py_NoneStruct = external global i8

; begin(arena, begin, addresses) -> where the state lies. The arena is a bytearray with room to spare for its alignment, `begin` how it begins, and
; `addresses` has pairs of a word of the state and what stands there: an offset into the arena.
define ptr @begin(ptr %module, ptr %arguments, i64 %given) {
  %arena = load ptr, ptr %arguments
  %begin = call ptr @pointer(ptr %arguments, i64 8)
  %addresses = call ptr @pointer(ptr %arguments, i64 16)
  %state = call i64 @begun(ptr %arena, ptr %begin, ptr %addresses)
  %object = call ptr @PyLong_FromUnsignedLongLong(i64 %state)
  ret ptr %object
}

define internal i64 @begun(ptr %arena, ptr %begin, ptr %addresses) {
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
  ret i64 %aligned
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

; is_readable(message) -> whether a message shows something now; where not, Python knows why.
define ptr @is_readable(ptr %module, ptr %arguments, i64 %given) {
  %message = load ptr, ptr %arguments
  %row = call ptr @row(ptr %message)
  %is = icmp ne ptr %row, null
  %answer = zext i1 %is to i8
  %object = call ptr @box_bool(i8 %answer)
  ret ptr %object
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
  call void @restarted(i64 %address, ptr %fresh)
  call void @Py_IncRef(ptr @_Py_NoneStruct)
  ret ptr @_Py_NoneStruct
}

define internal void @restarted(i64 %address, ptr %fresh) {
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
  ret void
}

; A recipe is a tuple of what a new holder has: the class of lanes, their plan, the class of arrays, how its root is read, how the memory begins, its
; addresses, words, how its rows begin (`restart`), and a list of lanes that others have left (`ending.ll`), or None. The words are 0 bytes of the
; arena, 8 how many messages, 16 the first lane's words, 24 the root's table, and where in lanes lie 32 the arena, 40 the plan, 48 the class of arrays,
; 56 the address, 64 whether they are filled, 72 the number of messages, 80 that list.
declare ptr @PyByteArray_FromStringAndSize(ptr, i64)

; spawn(class, recipe) -> a new holder
define ptr @spawn(ptr %module, ptr %arguments, i64 %given) {
  %class = load ptr, ptr %arguments
  %recipe = call ptr @pointer(ptr %arguments, i64 8)
  %holder = call ptr @spawned(ptr %class, ptr %recipe)
  ret ptr %holder
}

define internal ptr @spawned(ptr %class, ptr %recipe) {
  %holder = call ptr @PyType_GenericAlloc(ptr %class, i64 0)
  %made = icmp ne ptr %holder, null
  br i1 %made, label %fill, label %none
fill:
  %good = call i1 @equipped(ptr %holder, ptr %recipe)
  br i1 %good, label %done, label %drop
done:
  ret ptr %holder
drop:
  call void @Py_DecRef(ptr %holder)
  br label %none
none:
  ret ptr null
}

; equip(holder, recipe) -> whether the holder was new; else nothing is done.
define ptr @equip(ptr %module, ptr %arguments, i64 %given) {
  %holder = load ptr, ptr %arguments
  %recipe = call ptr @pointer(ptr %arguments, i64 8)
  %state = call i64 @word(ptr %holder, i64 16)
  %is.new = icmp eq i64 %state, 0
  br i1 %is.new, label %fill, label %old
fill:
  %good = call i1 @equipped(ptr %holder, ptr %recipe)
  br i1 %good, label %done, label %failed
done:
  %yes = call ptr @box_bool(i8 1)
  ret ptr %yes
old:
  %no = call ptr @box_bool(i8 0)
  ret ptr %no
failed:
  ret ptr null
}

; Give a new holder lanes; false if there is no memory, and an error is set.
define internal i1 @equipped(ptr %holder, ptr %recipe) {
  %class = call ptr @pointer(ptr %recipe, i64 24)
  %plan = call ptr @pointer(ptr %recipe, i64 32)
  %array = call ptr @pointer(ptr %recipe, i64 40)
  %access = call ptr @pointer(ptr %recipe, i64 48)
  %begin = call ptr @pointer(ptr %recipe, i64 56)
  %addresses = call ptr @pointer(ptr %recipe, i64 64)
  %words.object = call ptr @pointer(ptr %recipe, i64 72)
  %words = getelementptr i8, ptr %words.object, i64 32
  %size = load i64, ptr %words
  %first = call i64 @word(ptr %words, i64 16)
  %table = call i64 @word(ptr %words, i64 24)
  %spares = call ptr @pointer(ptr %recipe, i64 88)
  %spare = call ptr @unstash(ptr %spares)
  %is.spare = icmp ne ptr %spare, null
  br i1 %is.spare, label %again, label %anew
again:
  %arena.at = call i64 @word(ptr %words, i64 32)
  %its.arena = call ptr @pointer(ptr %spare, i64 %arena.at)
  %same.state = call i64 @begun(ptr %its.arena, ptr %begin, ptr %addresses)
  %fresh = call ptr @pointer(ptr %recipe, i64 80)
  call void @restarted(i64 %same.state, ptr %fresh)
  br label %bind
anew:
  %lanes = call ptr @PyType_GenericAlloc(ptr %class, i64 0)
  %has.lanes = icmp ne ptr %lanes, null
  br i1 %has.lanes, label %take, label %failed
take:
  %arena = call ptr @PyByteArray_FromStringAndSize(ptr null, i64 %size)
  %has.arena = icmp ne ptr %arena, null
  br i1 %has.arena, label %start, label %drop
start:
  %memory = call ptr @pointer(ptr %arena, i64 40)
  call void @llvm.memset.p0.i64(ptr %memory, i8 0, i64 %size, i1 false)
  %new.state = call i64 @begun(ptr %arena, ptr %begin, ptr %addresses)
  %rows = call i64 @word(ptr %words, i64 8)
  call void @fill_slot(ptr %lanes, ptr %words, i64 32, ptr %arena)
  call void @Py_IncRef(ptr %plan)
  call void @fill_slot(ptr %lanes, ptr %words, i64 40, ptr %plan)
  call void @Py_IncRef(ptr %array)
  call void @fill_slot(ptr %lanes, ptr %words, i64 48, ptr %array)
  %address.object = call ptr @PyLong_FromUnsignedLongLong(i64 %new.state)
  call void @fill_slot(ptr %lanes, ptr %words, i64 56, ptr %address.object)
  %filled = call ptr @box_bool(i8 1)
  call void @fill_slot(ptr %lanes, ptr %words, i64 64, ptr %filled)
  %rows.object = call ptr @PyLong_FromLongLong(i64 %rows)
  call void @fill_slot(ptr %lanes, ptr %words, i64 72, ptr %rows.object)
  %one = icmp ne ptr %address.object, null
  %two = icmp ne ptr %rows.object, null
  %whole = and i1 %one, %two
  br i1 %whole, label %offer, label %drop
offer:
  %are.kept = icmp ne ptr %spares, @_Py_NoneStruct
  br i1 %are.kept, label %note, label %bind
note:
  call void @keep(ptr %spares)
  call void @fill_slot(ptr %lanes, ptr %words, i64 80, ptr %spares)
  br label %bind
bind:
  %its = phi ptr [ %spare, %again ], [ %lanes, %offer ], [ %lanes, %note ]
  %state = phi i64 [ %same.state, %again ], [ %new.state, %offer ], [ %new.state, %note ]
  call void @set_slot(ptr %holder, i64 72, ptr %access)
  call void @set_slot(ptr %holder, i64 80, ptr @_Py_NoneStruct)
  call void @set_slot(ptr %holder, i64 88, ptr %its)
  call void @set_slot(ptr %holder, i64 96, ptr @_Py_NoneStruct)
  call void @put(ptr %holder, i64 24, i64 0)
  call void @put(ptr %holder, i64 32, i64 -9223372036854775808)
  call void @put(ptr %holder, i64 40, i64 %first)
  call void @put(ptr %holder, i64 48, i64 %table)
  call void @put(ptr %holder, i64 56, i64 0)
  call void @put(ptr %holder, i64 64, i64 0)
  call void @put(ptr %holder, i64 16, i64 %state)
  call void @Py_DecRef(ptr %its)
  %full = call i32 @populate(ptr %holder)
  %good = icmp eq i32 %full, 0
  ret i1 %good
drop:
  call void @Py_DecRef(ptr %lanes)
  br label %failed
failed:
  ret i1 false
}

; Put a reference that is given away where a word says.
define internal void @fill_slot(ptr %object, ptr %words, i64 %word, ptr %value) alwaysinline {
  %offset = call i64 @word(ptr %words, i64 %word)
  call void @put_pointer(ptr %object, i64 %offset, ptr %value)
  ret void
}
