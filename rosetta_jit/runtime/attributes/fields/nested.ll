; Messages within messages. A message keeps the view of each record in its row, and what shows each of its arrays and maps. The views are made with
; it (`Kept.MEMBER`), so that CPython's own quick way of reading slots finds them, or, where they would be many, like all else when they are first
; asked for. None of these leads back to it.

declare ptr @PyType_GenericAlloc(ptr, i64)

define ptr @get_kept(ptr %self, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %row = call ptr @row_at_once(ptr %self)
  %has.row = icmp ne ptr %row, null
  br i1 %has.row, label %look, label %python, !prof !0
look:
  %offset = call i64 @word(ptr %place, i64 64)
  %kept = call ptr @pointer(ptr %self, i64 %offset)
  %has = icmp ne ptr %kept, null
  br i1 %has, label %give, label %make, !prof !0
give:
  call void @keep(ptr %kept)
  ret ptr %kept
make:
  %type = call ptr @pointer(ptr %place, i64 96)
  %is.known = icmp ne ptr %type, null
  %kind = call i64 @word(ptr %place, i64 128)
  %is.message = icmp eq i64 %kind, 0
  %easy = and i1 %is.known, %is.message
  br i1 %easy, label %new, label %other
new:
  %view = call ptr @beside(ptr %self, ptr %place)
  %is.made = icmp ne ptr %view, null
  br i1 %is.made, label %remember, label %failed
other:
  %shown = call ptr @ask(ptr %self, ptr %place)
  %is.shown = icmp ne ptr %shown, null
  br i1 %is.shown, label %remember, label %failed
remember:
  %object = phi ptr [ %view, %new ], [ %shown, %other ]
  ; Python, or the collector of garbage, may have been first
  %before = call ptr @pointer(ptr %self, i64 %offset)
  %empty = icmp eq ptr %before, null
  br i1 %empty, label %store, label %done
store:
  call void @keep(ptr %object)
  call void @put_pointer(ptr %self, i64 %offset, ptr %object)
  br label %done
done:
  ret ptr %object
failed:
  ret ptr null
python:
  %asked = call ptr @ask(ptr %self, ptr %place)
  ret ptr %asked
}

; A view of another record in the row of a message.
define internal ptr @beside(ptr %message, ptr %place) {
  %parent = call ptr @pointer(ptr %message, i64 96)
  %entry = call ptr @pointer(ptr %message, i64 80)
  %lane = call i64 @word(ptr %message, i64 40)
  %span = call i64 @word(ptr %message, i64 64)
  %index = call i64 @word(ptr %message, i64 56)
  %row = call i64 @word(ptr %message, i64 24)
  %epoch = call i64 @word(ptr %message, i64 32)
  %view = call ptr @new_view(ptr %message, ptr %place, ptr %parent, ptr %entry, i64 %lane, i64 %span, i64 %index, i64 %row, i64 %epoch)
  ret ptr %view
}

; A view of the class that a place names, in the lanes of a message.
define internal ptr @new_view(ptr %message, ptr %place, ptr %parent, ptr %entry, i64 %lane, i64 %span, i64 %index, i64 %row, i64 %epoch) {
  %type = call ptr @pointer(ptr %place, i64 96)
  %view = call ptr @PyType_GenericAlloc(ptr %type, i64 0)
  %is.made = icmp ne ptr %view, null
  br i1 %is.made, label %fill, label %none
fill:
  %state = call ptr @pointer(ptr %message, i64 16)
  %table = call ptr @pointer(ptr %place, i64 104)
  %access = call ptr @pointer(ptr %place, i64 112)
  %lanes = call ptr @pointer(ptr %message, i64 88)
  call void @put_pointer(ptr %view, i64 16, ptr %state)
  call void @put(ptr %view, i64 40, i64 %lane)
  call void @put_pointer(ptr %view, i64 48, ptr %table)
  call void @put(ptr %view, i64 64, i64 %span)
  call void @keep(ptr %access)
  call void @put_pointer(ptr %view, i64 72, ptr %access)
  call void @Py_IncRef(ptr %entry)
  call void @put_pointer(ptr %view, i64 80, ptr %entry)
  call void @keep(ptr %lanes)
  call void @put_pointer(ptr %view, i64 88, ptr %lanes)
  call void @Py_IncRef(ptr %parent)
  call void @put_pointer(ptr %view, i64 96, ptr %parent)
  call void @point_at(ptr %view, i64 %index, i64 %row, i64 %epoch)
  %full = call i32 @populate(ptr %view)
  %good = icmp eq i32 %full, 0
  br i1 %good, label %done, label %drop
done:
  ret ptr %view
drop:
  call void @Py_DecRef(ptr %view)
  br label %none
none:
  ret ptr null
}

; Make the views that a new message has from the start; -1 if there is no memory for them.
define internal i32 @populate(ptr %message) {
  %table = call ptr @pointer(ptr %message, i64 48)
  %is.known = icmp ne ptr %table, null
  br i1 %is.known, label %begin, label %done
begin:
  %children = call ptr @pointer(ptr %table, i64 -8)
  %count = load i64, ptr %children
  br label %head
head:
  %number = phi i64 [ 0, %begin ], [ %next, %again ]
  %more = icmp slt i64 %number, %count
  br i1 %more, label %each, label %done
each:
  %next = add i64 %number, 1
  %base = mul i64 %number, 24
  %child = getelementptr i8, ptr %children, i64 %base
  %kind = call i64 @word(ptr %child, i64 16)
  %is.member = icmp eq i64 %kind, 0
  br i1 %is.member, label %make, label %again
make:
  %made = call i1 @make_member(ptr %message, ptr %child)
  br i1 %made, label %again, label %failed
again:
  br label %head
done:
  ret i32 0
failed:
  ret i32 -1
}

; Make the view of a record anew; its slot is empty. `%child` is in the list of what the message keeps: 8 offset, 16 kind, 24 place.
define internal i1 @make_member(ptr %message, ptr %child) {
  %offset = call i64 @word(ptr %child, i64 8)
  %place = call ptr @pointer(ptr %child, i64 24)
  %view = call ptr @beside(ptr %message, ptr %place)
  call void @put_pointer(ptr %message, i64 %offset, ptr %view)
  %made = icmp ne ptr %view, null
  ret i1 %made
}

define internal void @point_at(ptr %view, i64 %index, i64 %row, i64 %epoch) alwaysinline {
  call void @put(ptr %view, i64 56, i64 %index)
  call void @put(ptr %view, i64 24, i64 %row)
  call void @put(ptr %view, i64 32, i64 %epoch)
  ret void
}

; Whether nobody has an object but who keeps it, weakly neither.
define internal i1 @is_spare(ptr %object) alwaysinline {
  %references = load i32, ptr %object
  %one = icmp eq i32 %references, 1
  ret i1 %one
}

define internal i1 @is_spare_view(ptr %view) alwaysinline {
  %one = call i1 @is_spare(ptr %view)
  %weak = call ptr @pointer(ptr %view, i64 $MESSAGE_WEAK_LIST)
  %unseen = icmp eq ptr %weak, null
  %spare = and i1 %one, %unseen
  ret i1 %spare
}

; Let a view that nobody has, and what it keeps, show another element. What somebody has of it stays as it is, and is kept no more. False if there is
; no memory for what stands for that.
define internal i1 @move(ptr %view, i64 %index, i64 %row, i64 %epoch) {
  call void @point_at(ptr %view, i64 %index, i64 %row, i64 %epoch)
  %table = call ptr @pointer(ptr %view, i64 48)
  %children = call ptr @pointer(ptr %table, i64 -8)
  %count = load i64, ptr %children
  br label %head
head:
  %number = phi i64 [ 0, %0 ], [ %next, %again ]
  %more = icmp slt i64 %number, %count
  br i1 %more, label %each, label %done
each:
  %next = add i64 %number, 1
  %base = mul i64 %number, 24
  %child = getelementptr i8, ptr %children, i64 %base
  %offset = call i64 @word(ptr %child, i64 8)
  %kind = call i64 @word(ptr %child, i64 16)
  %kept = call ptr @pointer(ptr %view, i64 %offset)
  %has = icmp ne ptr %kept, null
  br i1 %has, label %sort, label %again
sort:
  switch i64 %kind, label %drop [ i64 0, label %message
                                  i64 1, label %message
                                  i64 2, label %sequence ]
message:
  %spare = call i1 @is_spare_view(ptr %kept)
  br i1 %spare, label %move.message, label %drop
move.message:
  ; most keep nothing themselves
  %its.table = call ptr @pointer(ptr %kept, i64 48)
  %its.children = call ptr @pointer(ptr %its.table, i64 -8)
  %its.count = load i64, ptr %its.children
  %is.leaf = icmp eq i64 %its.count, 0
  br i1 %is.leaf, label %move.leaf, label %move.whole
move.leaf:
  call void @point_at(ptr %kept, i64 %index, i64 %row, i64 %epoch)
  br label %again
move.whole:
  %moved = call i1 @move(ptr %kept, i64 %index, i64 %row, i64 %epoch)
  br i1 %moved, label %again, label %failed
sequence:
  %alone = call i1 @is_spare(ptr %kept)
  br i1 %alone, label %empty, label %drop
empty:
  call void @drop(ptr %kept, i64 48)
  call void @drop(ptr %kept, i64 56)
  %shown = call ptr @pointer(ptr %kept, i64 32)
  %still = call i1 @is_spare(ptr %kept)
  %shown.spare = call i1 @has_spare(ptr %shown)
  %both = and i1 %still, %shown.spare
  br i1 %both, label %move.shown, label %drop
move.shown:
  %shown.moved = call i1 @move(ptr %shown, i64 %index, i64 %row, i64 %epoch)
  br i1 %shown.moved, label %again, label %failed
drop:
  call void @drop(ptr %view, i64 %offset)
  %is.member = icmp eq i64 %kind, 0
  br i1 %is.member, label %replace, label %again
replace:
  %replaced = call i1 @make_member(ptr %view, ptr %child)
  br i1 %replaced, label %again, label %failed
again:
  br label %head
done:
  ret i1 true
failed:
  ret i1 false
}

define internal i1 @has_spare(ptr %view) alwaysinline {
  %has = icmp ne ptr %view, null
  br i1 %has, label %look, label %no
look:
  %spare = call i1 @is_spare_view(ptr %view)
  ret i1 %spare
no:
  ret i1 false
}

; Let go of an object that another one keeps.
define internal void @drop(ptr %keeper, i64 %offset) {
  %object = call ptr @pointer(ptr %keeper, i64 %offset)
  %has = icmp ne ptr %object, null
  br i1 %has, label %forget, label %done
forget:
  call void @put_pointer(ptr %keeper, i64 %offset, ptr null)
  call void @Py_DecRef(ptr %object)
  br label %done
done:
  ret void
}

; Attributes that are members cannot be set by CPython itself: a Python function, at the first word before the table's list, assigns to them.
declare i32 @PyObject_GenericSetAttr(ptr, ptr, ptr)
declare i32 @PyErr_ExceptionMatches(ptr)
declare void @PyErr_Fetch(ptr, ptr, ptr)
declare void @PyErr_Restore(ptr, ptr, ptr)

define internal i32 @set_any(ptr %self, ptr %name, ptr %value) noinline {
  %set = call i32 @PyObject_GenericSetAttr(ptr %self, ptr %name, ptr %value)
  %good = icmp eq i32 %set, 0
  br i1 %good, label %done, label %look, !prof !0
done:
  ret i32 0
look:
  %error = load ptr, ptr @PyExc_AttributeError
  %refused = call i32 @PyErr_ExceptionMatches(ptr %error)
  %table = call ptr @pointer(ptr %self, i64 48)
  %is.refused = icmp ne i32 %refused, 0
  %is.known = icmp ne ptr %table, null
  %is.given = icmp ne ptr %value, null
  %one = and i1 %is.refused, %is.known
  %can = and i1 %one, %is.given
  br i1 %can, label %assign, label %failed
assign:
  %answer = call i32 @assign(ptr %self, ptr %name, ptr %value, ptr %table)
  ret i32 %answer
failed:
  ret i32 -1
}

; The error stands if the function says that the attribute is none of its own.
define internal i32 @assign(ptr %self, ptr %name, ptr %value, ptr %table) noinline {
  %error.type = alloca ptr
  %error.value = alloca ptr
  %error.trace = alloca ptr
  call void @PyErr_Fetch(ptr %error.type, ptr %error.value, ptr %error.trace)
  %arguments = alloca [3 x ptr]
  %function = call ptr @pointer(ptr %table, i64 -16)
  store ptr %self, ptr %arguments
  %second = getelementptr ptr, ptr %arguments, i64 1
  store ptr %name, ptr %second
  %third = getelementptr ptr, ptr %arguments, i64 2
  store ptr %value, ptr %third
  %answer = call ptr @PyObject_Vectorcall(ptr %function, ptr %arguments, i64 3, ptr null)
  %type = load ptr, ptr %error.type
  %what = load ptr, ptr %error.value
  %trace = load ptr, ptr %error.trace
  %good = icmp ne ptr %answer, null
  br i1 %good, label %judge, label %failed
judge:
  call void @Py_DecRef(ptr %answer)
  %foreign = icmp eq ptr %answer, @_Py_FalseStruct
  br i1 %foreign, label %restore, label %done
restore:
  call void @PyErr_Restore(ptr %type, ptr %what, ptr %trace)
  ret i32 -1
done:
  call void @forget(ptr %type)
  call void @forget(ptr %what)
  call void @forget(ptr %trace)
  ret i32 0
failed:
  call void @forget(ptr %type)
  call void @forget(ptr %what)
  call void @forget(ptr %trace)
  ret i32 -1
}

define internal void @forget(ptr %object) {
  %has = icmp ne ptr %object, null
  br i1 %has, label %release, label %done
release:
  call void @Py_DecRef(ptr %object)
  br label %done
done:
  ret void
}
