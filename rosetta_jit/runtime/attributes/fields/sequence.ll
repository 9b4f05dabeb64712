; Arrays of messages, texts and bytes. Offsets into what shows one (`holder.sequence.Sequence`): 16 its place, and objects: 24 entry, 32 message,
; 40 node, 48 and 56 two views that it gave out last. A view that nobody has any more shows the next element that is asked for: in a loop, the
; name still has one view when the other is made.

declare i64 @PyLong_AsSsize_t(ptr)
declare void @PyObject_Free(ptr)

; The first row of an array and how many elements it has, -1 where Python must say it.
define internal { i64, i64 } @elements(ptr %self) alwaysinline {
  %place = call ptr @pointer(ptr %self, i64 16)
  %message = call ptr @pointer(ptr %self, i64 32)
  %has.place = icmp ne ptr %place, null
  %has.message = icmp ne ptr %message, null
  %is.made = and i1 %has.place, %has.message
  br i1 %is.made, label %find, label %none, !prof !0
find:
  %row = call ptr @row_at_once(ptr %message)
  %has.row = icmp ne ptr %row, null
  br i1 %has.row, label %read, label %none, !prof !0
read:
  %offset = load i64, ptr %place
  %span = getelementptr i8, ptr %row, i64 %offset
  %start = load i64, ptr %span
  %count = call i64 @word(ptr %span, i64 8)
  %positive = icmp sge i64 %count, 0
  %known = select i1 %positive, i64 %count, i64 -1
  br label %none
none:
  %first = phi i64 [ 0, %0 ], [ 0, %find ], [ %start, %read ]
  %found = phi i64 [ -1, %0 ], [ -1, %find ], [ %known, %read ]
  %one = insertvalue { i64, i64 } undef, i64 %first, 0
  %two = insertvalue { i64, i64 } %one, i64 %found, 1
  ret { i64, i64 } %two
}

; `len(sequence)`
define i64 @length(ptr %self) {
  %found = call { i64, i64 } @elements(ptr %self)
  %count = extractvalue { i64, i64 } %found, 1
  %known = icmp sge i64 %count, 0
  br i1 %known, label %done, label %python, !prof !0
done:
  ret i64 %count
python:
  %object = call ptr @ask_sequence(ptr %self, i64 136, ptr null)
  %good = icmp ne ptr %object, null
  br i1 %good, label %convert, label %failed
convert:
  %asked = call i64 @PyLong_AsSsize_t(ptr %object)
  call void @Py_DecRef(ptr %object)
  ret i64 %asked
failed:
  ret i64 -1
}

; `sequence[key]`
define ptr @subscript(ptr %self, ptr %key) {
  %converted = call { i64, i1 } @unbox_signed(ptr %key)
  %is.index = extractvalue { i64, i1 } %converted, 1
  br i1 %is.index, label %look, label %python, !prof !0
look:
  %found = call { i64, i64 } @elements(ptr %self)
  %count = extractvalue { i64, i64 } %found, 1
  %start = extractvalue { i64, i64 } %found, 0
  %given = extractvalue { i64, i1 } %converted, 0
  %from.end = add i64 %given, %count
  %negative = icmp slt i64 %given, 0
  %index = select i1 %negative, i64 %from.end, i64 %given
  %some = icmp sgt i64 %count, 0
  %inside = icmp ult i64 %index, %count
  %can = and i1 %some, %inside
  br i1 %can, label %take, label %python, !prof !0
take:
  %object = call ptr @element(ptr %self, ptr %key, i64 %start, i64 %index)
  ret ptr %object
python:
  %asked = call ptr @ask_sequence(ptr %self, i64 144, ptr %key)
  ret ptr %asked
}

; Element `index` of a sequence, which has so many; `key` is the same as an object, or null.
define internal ptr @element(ptr %self, ptr %key, i64 %start, i64 %index) alwaysinline {
  %place = call ptr @pointer(ptr %self, i64 16)
  %message = call ptr @pointer(ptr %self, i64 32)
  %row = add i64 %start, %index
  %kind = call i64 @word(ptr %place, i64 128)
  switch i64 %kind, label %python [ i64 1, label %is.view
                                    i64 2, label %is.text
                                    i64 3, label %is.octets ]
is.view:
  %type = call ptr @pointer(ptr %place, i64 96)
  %known = icmp ne ptr %type, null
  br i1 %known, label %show, label %python, !prof !0
show:
  %view = call ptr @view_of_element(ptr %self, ptr %message, ptr %place, i64 %index, i64 %row)
  ret ptr %view
is.text:
  br label %read
is.octets:
  br label %read
read:
  %errors = phi ptr [ null, %is.text ], [ @surrogateescape, %is.octets ]
  %found = call { ptr, i64, i64 } @span_of_element(ptr %message, ptr %place, i64 %row)
  %data = extractvalue { ptr, i64, i64 } %found, 0
  %count = extractvalue { ptr, i64, i64 } %found, 2
  %there = icmp ne ptr %data, null
  br i1 %there, label %decode, label %python, !prof !0
decode:
  %text = call ptr @PyUnicode_DecodeUTF8(ptr %data, i64 %count, ptr %errors)
  ret ptr %text
python:
  %has.key = icmp ne ptr %key, null
  br i1 %has.key, label %ask, label %number
number:
  %made = call ptr @PyLong_FromLongLong(i64 %index)
  %is.made = icmp ne ptr %made, null
  br i1 %is.made, label %ask.made, label %raise
ask.made:
  %answer = call ptr @ask_sequence(ptr %self, i64 144, ptr %made)
  call void @Py_DecRef(ptr %made)
  ret ptr %answer
ask:
  %asked = call ptr @ask_sequence(ptr %self, i64 144, ptr %key)
  ret ptr %asked
raise:
  ret ptr null
}

; Where the text of an element lies.
define internal { ptr, i64, i64 } @span_of_element(ptr %message, ptr %place, i64 %row) noinline {
  %elements = call ptr @lane_of(ptr %message, ptr %place)
  %at = call ptr @element_row(ptr %elements, i64 %row)
  %used = icmp ne ptr %at, null
  br i1 %used, label %look, label %none, !prof !0
look:
  %offset = call i64 @word(ptr %place, i64 160)
  %span = getelementptr i8, ptr %at, i64 %offset
  %state = call ptr @pointer(ptr %message, i64 16)
  %target = call i64 @word(ptr %place, i64 168)
  %lane = getelementptr i8, ptr %state, i64 %target
  %found = call { ptr, i64, i64 } @span_at(ptr %message, ptr %span, ptr %lane)
  ret { ptr, i64, i64 } %found
none:
  ret { ptr, i64, i64 } zeroinitializer
}

define internal ptr @view_of_element(ptr %self, ptr %message, ptr %place, i64 %index, i64 %row) alwaysinline {
  %state = call ptr @pointer(ptr %message, i64 16)
  %now = call i64 @word(ptr %state, i64 8)
  ; while somebody changes the lanes no row is known for long
  %free = icmp sge i64 %now, 0
  %epoch = select i1 %free, i64 %now, i64 -9223372036854775807
  %last = call ptr @pointer(ptr %self, i64 48)
  %last.spare = call i1 @has_spare(ptr %last)
  br i1 %last.spare, label %reuse, label %other
other:
  %one = call ptr @pointer(ptr %self, i64 56)
  %one.spare = call i1 @has_spare(ptr %one)
  br i1 %one.spare, label %reuse, label %new
reuse:
  %view = phi ptr [ %last, %0 ], [ %one, %other ]
  call void @keep(ptr %view)
  %its.index = call i64 @word(ptr %view, i64 56)
  %its.row = call i64 @word(ptr %view, i64 24)
  %same.index = icmp eq i64 %its.index, %index
  %same.row = icmp eq i64 %its.row, %row
  %same.place = and i1 %same.index, %same.row
  br i1 %same.place, label %stay, label %turn
stay:
  ; what it keeps looks for its row again where the epoch is another: most of it is not asked for
  call void @put(ptr %view, i64 32, i64 %epoch)
  br label %give
turn:
  %moved = call i1 @move(ptr %view, i64 %index, i64 %row, i64 %epoch)
  br i1 %moved, label %give, label %failed, !prof !0
give:
  ret ptr %view
failed:
  call void @Py_DecRef(ptr %view)
  ret ptr null
new:
  %entry = call ptr @pointer(ptr %place, i64 120)
  %lane = call i64 @word(ptr %place, i64 56)
  %span = load i64, ptr %place
  %made = call ptr @new_view(ptr %message, ptr %place, ptr %message, ptr %entry, i64 %lane, i64 %span, i64 %index, i64 %row, i64 %epoch)
  %is.made = icmp ne ptr %made, null
  br i1 %is.made, label %remember, label %done
remember:
  %older = call ptr @pointer(ptr %self, i64 48)
  call void @keep(ptr %made)
  call void @put_pointer(ptr %self, i64 48, ptr %made)
  %oldest = call ptr @pointer(ptr %self, i64 56)
  call void @put_pointer(ptr %self, i64 56, ptr %older)
  %has.oldest = icmp ne ptr %oldest, null
  br i1 %has.oldest, label %forget, label %done
forget:
  call void @Py_DecRef(ptr %oldest)
  br label %done
done:
  ret ptr %made
}

; What a Python function of the sequence's place says, of the sequence or of one element.
define internal ptr @ask_sequence(ptr %self, i64 %which, ptr %key) noinline {
  %arguments = alloca [2 x ptr]
  %place = call ptr @pointer(ptr %self, i64 16)
  %made = icmp ne ptr %place, null
  br i1 %made, label %call, label %refused
call:
  %function = call ptr @pointer(ptr %place, i64 %which)
  store ptr %self, ptr %arguments
  %second = getelementptr ptr, ptr %arguments, i64 1
  store ptr %key, ptr %second
  %has.key = icmp ne ptr %key, null
  %count = select i1 %has.key, i64 2, i64 1
  %answer = call ptr @PyObject_Vectorcall(ptr %function, ptr %arguments, i64 %count, ptr null)
  ret ptr %answer
refused:
  call void @refuse()
  ret ptr null
}

; `iter(sequence)`: an iterator has the sequence at 16 and the next index at 24.
define ptr @iterate(ptr %self) {
  %place = call ptr @pointer(ptr %self, i64 16)
  %made = icmp ne ptr %place, null
  br i1 %made, label %new, label %refused
new:
  %type = call ptr @pointer(ptr %place, i64 152)
  %iterator = call ptr @PyType_GenericAlloc(ptr %type, i64 0)
  %is.made = icmp ne ptr %iterator, null
  br i1 %is.made, label %fill, label %done
fill:
  call void @keep(ptr %self)
  call void @put_pointer(ptr %iterator, i64 16, ptr %self)
  br label %done
done:
  ret ptr %iterator
refused:
  call void @refuse()
  ret ptr null
}

define ptr @itself(ptr %self) {
  call void @keep(ptr %self)
  ret ptr %self
}

define ptr @next(ptr %self) {
  %sequence = call ptr @pointer(ptr %self, i64 16)
  %index = call i64 @word(ptr %self, i64 24)
  %found = call { i64, i64 } @elements(ptr %sequence)
  %start = extractvalue { i64, i64 } %found, 0
  %count = extractvalue { i64, i64 } %found, 1
  %more = icmp slt i64 %index, %count
  br i1 %more, label %take, label %end, !prof !0
take:
  %following = add i64 %index, 1
  call void @put(ptr %self, i64 24, i64 %following)
  %object = call ptr @element(ptr %sequence, ptr null, i64 %start, i64 %index)
  ret ptr %object
end:
  %known = icmp sge i64 %count, 0
  br i1 %known, label %stop, label %raise
raise:
  ; to ask how many there are says what is wrong
  %asked = call ptr @ask_sequence(ptr %sequence, i64 136, ptr null)
  %good = icmp ne ptr %asked, null
  br i1 %good, label %drop, label %stop
drop:
  call void @Py_DecRef(ptr %asked)
  br label %stop
stop:
  ret ptr null
}

; What an iterator leaves. Its type is an object that its instances count.
define void @end_iterator(ptr %self) {
  %type = call ptr @pointer(ptr %self, i64 8)
  call void @drop(ptr %self, i64 16)
  call void @PyObject_Free(ptr %self)
  call void @Py_DecRef(ptr %type)
  ret void
}
