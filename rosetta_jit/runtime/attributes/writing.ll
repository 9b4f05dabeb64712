; Assignment to fields whose content lies in a lane of its own, by values of exactly the common types: str, bytes, lists of numbers or of texts, arrays.
;
; New content is written where the old one lies if it is as long, or ends its lane; else behind the lane's last row, and the old rows are wasted
; (word 15 of the state): where that is much, the next encode tidies up. Whether there is room is asked first. Where there is none, Python makes it;
; then all is looked up again.

@PyUnicode_Type = external global i8
@PyList_Type = external global i8
@PyTuple_Type = external global i8
declare ptr @PyUnicode_AsUTF8AndSize(ptr, ptr)
declare void @PyErr_Clear()
declare void @llvm.memmove.p0.p0.i64(ptr, ptr, i64, i1)
declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)

; How many rows a lane lacks so that a span can have so many; -1 if Python must do it, because the span is borrowed.
define internal i64 @lacking(ptr %lane, ptr %span, i64 %count) {
  %start = load i64, ptr %span
  %old = call i64 @word(ptr %span, i64 8)
  %capacity = call i64 @word(ptr %lane, i64 8)
  %used = call i64 @word(ptr %lane, i64 16)
  %sound = call i1 @is_sound(i64 %start, i64 %old, i64 %used)
  br i1 %sound, label %compare, label %python
compare:
  %end = add i64 %start, %old
  %at.end = icmp eq i64 %end, %used
  %same = icmp eq i64 %count, %old
  br i1 %same, label %enough, label %differ
differ:
  %some = icmp ne i64 %old, 0
  %here = and i1 %some, %at.end
  %begin = select i1 %here, i64 %start, i64 %used
  %last = add i64 %begin, %count
  %missing = sub i64 %last, %capacity
  %fewer = icmp slt i64 %count, %old
  %fits = icmp sle i64 %missing, 0
  %easy = or i1 %fits, %fewer
  br i1 %easy, label %enough, label %lack
enough:
  ret i64 0
lack:
  ret i64 %missing
python:
  ret i64 -1
}

; Whether a span lies among the used rows of its lane.
define internal i1 @is_sound(i64 %start, i64 %count, i64 %used) alwaysinline {
  %few = icmp ule i64 %count, %used
  %last = sub i64 %used, %count
  %early = icmp ule i64 %start, %last
  %sound = and i1 %few, %early
  ret i1 %sound
}

; Give a span so many rows, for which there is room; where they begin. What they hold is not kept.
define internal ptr @resized(ptr %state, ptr %lane, ptr %span, i64 %count) {
  %start = load i64, ptr %span
  %old = call i64 @word(ptr %span, i64 8)
  %address = load ptr, ptr %lane
  %used = call i64 @word(ptr %lane, i64 16)
  %stride = call i64 @word(ptr %lane, i64 24)
  %end = add i64 %start, %old
  %some = icmp ne i64 %old, 0
  %last = icmp eq i64 %end, %used
  %at.end = and i1 %some, %last
  %same = icmp eq i64 %count, %old
  br i1 %same, label %place, label %differ
differ:
  br i1 %at.end, label %here, label %elsewhere
here:
  %new.end = add i64 %start, %count
  call void @put(ptr %lane, i64 16, i64 %new.end)
  br label %place
elsewhere:
  %fewer = icmp slt i64 %count, %old
  %left = sub i64 %old, %count
  %lost = select i1 %fewer, i64 %left, i64 %old
  %bytes = mul i64 %lost, %stride
  call void @waste(ptr %state, ptr %lane, i64 %bytes)
  br i1 %fewer, label %place, label %append
append:
  %behind = add i64 %used, %count
  call void @put(ptr %lane, i64 16, i64 %behind)
  br label %place
place:
  %begin = phi i64 [ %start, %0 ], [ %start, %here ], [ %start, %elsewhere ], [ %used, %append ]
  store i64 %begin, ptr %span
  call void @put(ptr %span, i64 8, i64 %count)
  %distance = mul i64 %begin, %stride
  %at = getelementptr i8, ptr %address, i64 %distance
  ret ptr %at
}

; Note that bytes of a lane are not referred to any more. Where that is more than half of what it holds, encoders must not read it as it is
; (`kernel.state.UNSETTLED`), so that they put all in order.
define internal void @waste(ptr %state, ptr %lane, i64 %bytes) {
  %before = call i64 @word(ptr %state, i64 120)
  %wasted = add i64 %before, %bytes
  call void @put(ptr %state, i64 120, i64 %wasted)
  %capacity = call i64 @word(ptr %lane, i64 8)
  %stride = call i64 @word(ptr %lane, i64 24)
  %size = mul i64 %capacity, %stride
  %half = lshr i64 %size, 1
  %many = icmp ugt i64 %wasted, 65536
  %most = icmp ugt i64 %wasted, %half
  %much = and i1 %many, %most
  br i1 %much, label %unsettle, label %done
unsettle:
  store i64 2, ptr %state
  br label %done
done:
  ret void
}

; Let Python make room for so many rows more of a lane.
define internal i1 @make_room(ptr %self, ptr %place, i64 %lane, i64 %rows) noinline {
  %arguments = alloca [3 x ptr]
  %maker = call ptr @pointer(ptr %place, i64 176)
  %lane.object = call ptr @PyLong_FromLongLong(i64 %lane)
  %rows.object = call ptr @PyLong_FromLongLong(i64 %rows)
  %one = icmp ne ptr %lane.object, null
  %two = icmp ne ptr %rows.object, null
  %both = and i1 %one, %two
  br i1 %both, label %call, label %failed
call:
  store ptr %self, ptr %arguments
  %second = getelementptr ptr, ptr %arguments, i64 1
  store ptr %lane.object, ptr %second
  %third = getelementptr ptr, ptr %arguments, i64 2
  store ptr %rows.object, ptr %third
  %answer = call ptr @PyObject_Vectorcall(ptr %maker, ptr %arguments, i64 3, ptr null)
  %made = icmp ne ptr %answer, null
  call void @forget(ptr %answer)
  br i1 %made, label %done, label %failed
failed:
  ; Python's own assignment says what is wrong
  call void @PyErr_Clear()
  br label %done
done:
  %is = phi i1 [ true, %call ], [ false, %failed ]
  call void @forget(ptr %lane.object)
  call void @forget(ptr %rows.object)
  ret i1 %is
}

; The bytes of exactly a str, as UTF-8, or of exactly a bytes object; null if it is none, or has no UTF-8.
define internal { ptr, i64 } @bytes_of(ptr %value, ptr %type) alwaysinline {
  %size.at = alloca i64
  %is = call i1 @is_exactly(ptr %value, ptr %type)
  br i1 %is, label %look, label %none
look:
  %is.text = icmp eq ptr %type, @PyUnicode_Type
  br i1 %is.text, label %text, label %raw
text:
  %utf8 = call ptr @PyUnicode_AsUTF8AndSize(ptr %value, ptr %size.at)
  %good = icmp ne ptr %utf8, null
  br i1 %good, label %measure, label %wrong
wrong:
  call void @PyErr_Clear()
  br label %none
measure:
  %size = load i64, ptr %size.at
  br label %none
raw:
  %data = getelementptr i8, ptr %value, i64 32
  %length = call i64 @word(ptr %value, i64 16)
  br label %none
none:
  %at = phi ptr [ null, %0 ], [ null, %wrong ], [ %utf8, %measure ], [ %data, %raw ]
  %count = phi i64 [ 0, %0 ], [ 0, %wrong ], [ %size, %measure ], [ %length, %raw ]
  %one = insertvalue { ptr, i64 } undef, ptr %at, 0
  %two = insertvalue { ptr, i64 } %one, i64 %count, 1
  ret { ptr, i64 } %two
}

define i32 @set_utf8(ptr %self, ptr %value, ptr %field) {
  %answer = call i32 @set_content(ptr %self, ptr %value, ptr %field, ptr @PyUnicode_Type)
  ret i32 %answer
}

define i32 @set_bytes(ptr %self, ptr %value, ptr %field) {
  %answer = call i32 @set_content(ptr %self, ptr %value, ptr %field, ptr @PyBytes_Type)
  ret i32 %answer
}

@PyBytes_Type = external global i8

define internal i32 @set_content(ptr %self, ptr %value, ptr %field, ptr %type) {
  %place = call ptr @place(ptr %self, ptr %field)
  %given = icmp ne ptr %value, null
  br i1 %given, label %convert, label %python
convert:
  %content = call { ptr, i64 } @bytes_of(ptr %value, ptr %type)
  %data = extractvalue { ptr, i64 } %content, 0
  %count = extractvalue { ptr, i64 } %content, 1
  %is = icmp ne ptr %data, null
  br i1 %is, label %make, label %python, !prof !0
make:
  %target = call ptr @room(ptr %self, ptr %place, i64 %count)
  %has = icmp ne ptr %target, null
  br i1 %has, label %copy, label %python, !prof !0
copy:
  call void @llvm.memmove.p0.p0.i64(ptr %target, ptr %data, i64 %count, i1 false)
  ret i32 0
python:
  %told = call i32 @tell(ptr %self, ptr %place, ptr %value)
  ret i32 %told
}

; Where so many rows of a field are to be written, which is present from now on; null where Python must write them.
define internal ptr @room(ptr %self, ptr %place, i64 %count) {
  br label %find
find:
  %again = phi i1 [ false, %0 ], [ true, %made ]
  %row = call ptr @row(ptr %self)
  %has.row = icmp ne ptr %row, null
  br i1 %has.row, label %measure, label %python, !prof !0
measure:
  %least = call i64 @word(ptr %place, i64 80)
  %most = call i64 @word(ptr %place, i64 88)
  %enough = icmp sge i64 %count, %least
  %few = icmp sle i64 %count, %most
  %allowed = and i1 %enough, %few
  br i1 %allowed, label %look, label %python, !prof !0
look:
  %offset = load i64, ptr %place
  %span = getelementptr i8, ptr %row, i64 %offset
  %state = call ptr @pointer(ptr %self, i64 16)
  %lane = call ptr @lane_of(ptr %self, ptr %place)
  %missing = call i64 @lacking(ptr %lane, ptr %span, i64 %count)
  %fits = icmp eq i64 %missing, 0
  br i1 %fits, label %begin, label %grow, !prof !0
grow:
  %known = icmp sgt i64 %missing, 0
  %first = xor i1 %again, true
  %can = and i1 %known, %first
  br i1 %can, label %ask, label %python
ask:
  %lane.at = call i64 @word(ptr %place, i64 56)
  %is.made = call i1 @make_room(ptr %self, ptr %place, i64 %lane.at, i64 %missing)
  br i1 %is.made, label %made, label %python
made:
  br label %find
begin:
  %begun = call i1 @begin_writing(ptr %self, ptr %place, ptr %row)
  br i1 %begun, label %resize, label %python, !prof !0
resize:
  %target = call ptr @resized(ptr %state, ptr %lane, ptr %span, i64 %count)
  ret ptr %target
python:
  ret ptr null
}

; A list of numbers. `%kind` of the place's cells is the number of their scalar in `runtime.cells.SCALARS`.
define i32 @set_numbers(ptr %self, ptr %value, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %given = icmp ne ptr %value, null
  br i1 %given, label %sort, label %python
sort:
  %is.list = call i1 @is_exactly(ptr %value, ptr @PyList_Type)
  %is.tuple = call i1 @is_exactly(ptr %value, ptr @PyTuple_Type)
  %is.either = or i1 %is.list, %is.tuple
  br i1 %is.either, label %list, label %other
list:
  %count = call i64 @word(ptr %value, i64 16)
  %items = call ptr @items_of(ptr %value, i1 %is.list)
  %kind = call i64 @word(ptr %place, i64 184)
  %good = call i1 @store_all(ptr null, ptr %items, i64 %count, i64 %kind)
  br i1 %good, label %make, label %python
make:
  %target = call ptr @room(ptr %self, ptr %place, i64 %count)
  %has = icmp ne ptr %target, null
  br i1 %has, label %look.again, label %python
look.again:
  ; making room may have run other code
  %now = call i64 @word(ptr %value, i64 16)
  %now.items = call ptr @items_of(ptr %value, i1 %is.list)
  %same.count = icmp eq i64 %now, %count
  br i1 %same.count, label %store, label %python
store:
  %stored = call i1 @store_all(ptr %target, ptr %now.items, i64 %count, i64 %kind)
  br i1 %stored, label %done, label %python
done:
  ret i32 0
other:
  %array.type = call ptr @pointer(ptr %place, i64 192)
  %is.array = call i1 @is_exactly(ptr %value, ptr %array.type)
  br i1 %is.array, label %array, label %python
array:
  %copied = call i1 @copy_array(ptr %self, ptr %place, ptr %value)
  br i1 %copied, label %done, label %python
python:
  %told = call i32 @tell(ptr %self, ptr %place, ptr %value)
  ret i32 %told
}

; Copy an array of one dimension, contiguous and of the field's type. Its buffer has: data 0, bytes 16, dimensions 36, format 40.
define internal i1 @copy_array(ptr %self, ptr %place, ptr %array) {
  %view = alloca [80 x i8], align 8
  ; PyBUF_FORMAT | PyBUF_C_CONTIGUOUS
  %got = call i32 @PyObject_GetBuffer(ptr %array, ptr %view, i32 60)
  %has = icmp eq i32 %got, 0
  br i1 %has, label %look, label %clear
clear:
  call void @PyErr_Clear()
  ret i1 false
look:
  %dimensions.at = getelementptr i8, ptr %view, i64 36
  %dimensions = load i32, ptr %dimensions.at
  %flat = icmp eq i32 %dimensions, 1
  %said = call ptr @pointer(ptr %view, i64 40)
  %first = load i8, ptr %said
  ; of an array that is not aligned: the byte order is the machine's
  %is.order = icmp eq i8 %first, 61
  %shift = zext i1 %is.order to i64
  %format = getelementptr i8, ptr %said, i64 %shift
  %letters = load i16, ptr %format, align 1
  %size = call i64 @word(ptr %view, i64 24)
  %item = call i64 @word(ptr %place, i64 208)
  %is.size = icmp eq i64 %size, %item
  %wanted = call i64 @word(ptr %place, i64 200)
  %one = trunc i64 %wanted to i16
  %shifted = lshr i64 %wanted, 16
  %other = trunc i64 %shifted to i16
  %is.one = icmp eq i16 %letters, %one
  %is.other = icmp eq i16 %letters, %other
  %is.letter = or i1 %is.one, %is.other
  %is.type = and i1 %is.letter, %is.size
  %same = and i1 %flat, %is.type
  br i1 %same, label %make, label %release
make:
  %bytes = call i64 @word(ptr %view, i64 16)
  %count = udiv i64 %bytes, %size
  %target = call ptr @room(ptr %self, ptr %place, i64 %count)
  %is.made = icmp ne ptr %target, null
  br i1 %is.made, label %copy, label %release
copy:
  %data = load ptr, ptr %view
  call void @llvm.memmove.p0.p0.i64(ptr %target, ptr %data, i64 %bytes, i1 false)
  br label %release
release:
  %done = phi i1 [ false, %look ], [ false, %make ], [ true, %copy ]
  call void @PyBuffer_Release(ptr %view)
  ret i1 %done
}
declare i32 @PyObject_GetBuffer(ptr, ptr, i32)
declare void @PyBuffer_Release(ptr)

; Where the items of a list, or of a tuple, stand.
define internal ptr @items_of(ptr %value, i1 %is.list) alwaysinline {
  %within = getelementptr i8, ptr %value, i64 24
  br i1 %is.list, label %list, label %tuple
list:
  %elsewhere = load ptr, ptr %within
  ret ptr %elsewhere
tuple:
  ret ptr %within
}

; The same of floats that become float64, which are most.
define internal i1 @are_floats(ptr %items, i64 %count) {
  br label %head
head:
  %index = phi i64 [ 0, %0 ], [ %next, %each ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %yes
each:
  %next = add i64 %index, 1
  %item.at = getelementptr ptr, ptr %items, i64 %index
  %item = load ptr, ptr %item.at
  %is = call i1 @is_exactly(ptr %item, ptr @PyFloat_Type)
  br i1 %is, label %head, label %no
yes:
  ret i1 true
no:
  ret i1 false
}

define internal void @store_floats(ptr %target, ptr %items, i64 %count) {
  br label %head
head:
  %index = phi i64 [ 0, %0 ], [ %next, %each ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %next = add i64 %index, 1
  %item.at = getelementptr ptr, ptr %items, i64 %index
  %item = load ptr, ptr %item.at
  %value = call i64 @word(ptr %item, i64 16)
  %at = getelementptr i64, ptr %target, i64 %index
  store i64 %value, ptr %at
  br label %head
done:
  ret void
}

; Store numbers as cells of a kind, or, without a target, see whether all can be.
define internal i1 @store_all(ptr %target, ptr %items, i64 %count, i64 %kind) {
  %is.common = icmp eq i64 %kind, 10
  br i1 %is.common, label %look, label %slowly
look:
  %all = call i1 @are_floats(ptr %items, i64 %count)
  br i1 %all, label %quickly, label %slowly
quickly:
  %is.to.be.stored = icmp ne ptr %target, null
  br i1 %is.to.be.stored, label %copy, label %done
copy:
  call void @store_floats(ptr %target, ptr %items, i64 %count)
  br label %done
slowly:
  br label %head
head:
  %index = phi i64 [ 0, %slowly ], [ %next, %again ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %next = add i64 %index, 1
  %item.at = getelementptr ptr, ptr %items, i64 %index
  %item = load ptr, ptr %item.at
  %is.float = icmp uge i64 %kind, 9
  br i1 %is.float, label %float, label %integer
float:
  %converted = call { double, i1 } @unbox_real(ptr %item)
  %real = extractvalue { double, i1 } %converted, 0
  %is.real = extractvalue { double, i1 } %converted, 1
  br i1 %is.real, label %maybe.real, label %no
maybe.real:
  %store.real = icmp ne ptr %target, null
  br i1 %store.real, label %put.real, label %again
put.real:
  %is.double = icmp eq i64 %kind, 10
  br i1 %is.double, label %put.double, label %put.single
put.double:
  %double.at = getelementptr double, ptr %target, i64 %index
  store double %real, ptr %double.at
  br label %again
put.single:
  %single = fptrunc double %real to float
  %single.at = getelementptr float, ptr %target, i64 %index
  store float %single, ptr %single.at
  br label %again
integer:
  %whole = call { i64, i1 } @unbox_signed(ptr %item)
  %number = extractvalue { i64, i1 } %whole, 0
  %is.whole = extractvalue { i64, i1 } %whole, 1
  br i1 %is.whole, label %width, label %no
width:
  switch i64 %kind, label %no [ i64 1, label %i8
                                i64 2, label %u8
                                i64 3, label %i16
                                i64 4, label %u16
                                i64 5, label %i32
                                i64 6, label %u32
                                i64 7, label %i64
                                i64 8, label %u64 ]
i8:
  %to.i8 = trunc i64 %number to i8
  %from.i8 = sext i8 %to.i8 to i64
  br label %check
u8:
  %to.u8 = trunc i64 %number to i8
  %from.u8 = zext i8 %to.u8 to i64
  br label %check
i16:
  %to.i16 = trunc i64 %number to i16
  %from.i16 = sext i16 %to.i16 to i64
  br label %check
u16:
  %to.u16 = trunc i64 %number to i16
  %from.u16 = zext i16 %to.u16 to i64
  br label %check
i32:
  %to.i32 = trunc i64 %number to i32
  %from.i32 = sext i32 %to.i32 to i64
  br label %check
u32:
  %to.u32 = trunc i64 %number to i32
  %from.u32 = zext i32 %to.u32 to i64
  br label %check
i64:
  br label %check
u64:
  %magnitude = and i64 %number, 9223372036854775807
  br label %check
check:
  %back = phi i64 [ %from.i8, %i8 ], [ %from.u8, %u8 ], [ %from.i16, %i16 ], [ %from.u16, %u16 ], [ %from.i32, %i32 ], [ %from.u32, %u32 ], [ %number, %i64 ], [ %magnitude, %u64 ]
  %log = phi i64 [ 0, %i8 ], [ 0, %u8 ], [ 1, %i16 ], [ 1, %u16 ], [ 2, %i32 ], [ 2, %u32 ], [ 3, %i64 ], [ 3, %u64 ]
  %fits = icmp eq i64 %back, %number
  br i1 %fits, label %maybe.whole, label %no
maybe.whole:
  %store.whole = icmp ne ptr %target, null
  br i1 %store.whole, label %put.whole, label %again
put.whole:
  %distance = shl i64 %index, %log
  %at = getelementptr i8, ptr %target, i64 %distance
  switch i64 %log, label %put.i64 [ i64 0, label %put.i8
                                    i64 1, label %put.i16
                                    i64 2, label %put.i32 ]
put.i8:
  %cell.i8 = trunc i64 %number to i8
  store i8 %cell.i8, ptr %at
  br label %again
put.i16:
  %cell.i16 = trunc i64 %number to i16
  store i16 %cell.i16, ptr %at
  br label %again
put.i32:
  %cell.i32 = trunc i64 %number to i32
  store i32 %cell.i32, ptr %at
  br label %again
put.i64:
  store i64 %number, ptr %at
  br label %again
again:
  br label %head
done:
  ret i1 true
no:
  ret i1 false
}

; A list of texts. Their rows are made first; each text is then written where the old one of its row lies, or behind the others.
define i32 @set_texts(ptr %self, ptr %value, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %given = icmp ne ptr %value, null
  br i1 %given, label %sort, label %python
sort:
  %is.list = call i1 @is_exactly(ptr %value, ptr @PyList_Type)
  br i1 %is.list, label %list, label %python
list:
  %count = call i64 @word(ptr %value, i64 16)
  %items = call ptr @pointer(ptr %value, i64 24)
  %longest = call i64 @word(ptr %place, i64 224)
  %total = call i64 @total_size(ptr %items, i64 %count, i64 %longest)
  %good = icmp sge i64 %total, 0
  br i1 %good, label %make, label %python
make:
  %done = call i1 @write_texts(ptr %self, ptr %place, ptr %value, i64 0, i64 %count, i64 %total)
  br i1 %done, label %end, label %python
end:
  ret i32 0
python:
  %told = call i32 @tell(ptr %self, ptr %place, ptr %value)
  ret i32 %told
}

; How many bytes texts have together; -1 if one is none, or has more bytes than it may.
define internal i64 @total_size(ptr %items, i64 %count, i64 %most) {
  br label %head
head:
  %index = phi i64 [ 0, %0 ], [ %next, %add ]
  %sum = phi i64 [ 0, %0 ], [ %added, %add ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %next = add i64 %index, 1
  %item.at = getelementptr ptr, ptr %items, i64 %index
  %item = load ptr, ptr %item.at
  %content = call { ptr, i64 } @bytes_of(ptr %item, ptr @PyUnicode_Type)
  %data = extractvalue { ptr, i64 } %content, 0
  %size = extractvalue { ptr, i64 } %content, 1
  %is = icmp ne ptr %data, null
  %short = icmp sle i64 %size, %most
  %allowed = and i1 %is, %short
  br i1 %allowed, label %add, label %no
add:
  %added = add i64 %sum, %size
  br label %head
done:
  ret i64 %sum
no:
  ret i64 -1
}

; Write the texts of a list, of which the size is known, into the elements of a field from one on; the field has them and those before it. The list
; is looked at again where other code may have run. False, and the field is as it was, where Python must do it.
define internal i1 @write_texts(ptr %self, ptr %place, ptr %list, i64 %first, i64 %count, i64 %total) {
  %most = call i64 @word(ptr %place, i64 88)
  %least = call i64 @word(ptr %place, i64 80)
  %all = add i64 %first, %count
  %few = icmp sle i64 %all, %most
  %enough = icmp sge i64 %all, %least
  %allowed = and i1 %few, %enough
  br i1 %allowed, label %find, label %python
find:
  %tries = phi i64 [ 0, %0 ], [ %tried, %find.again ]
  %row = call ptr @row(ptr %self)
  %has.row = icmp ne ptr %row, null
  br i1 %has.row, label %look, label %python
look:
  %offset = load i64, ptr %place
  %span = getelementptr i8, ptr %row, i64 %offset
  %state = call ptr @pointer(ptr %self, i64 16)
  %lane = call ptr @lane_of(ptr %self, ptr %place)
  %target.at = call i64 @word(ptr %place, i64 168)
  %texts = getelementptr i8, ptr %state, i64 %target.at
  %capacity = call i64 @word(ptr %texts, i64 8)
  %used = call i64 @word(ptr %texts, i64 16)
  %behind = add i64 %used, %total
  %text.lack = sub i64 %behind, %capacity
  %text.lacks = icmp sgt i64 %text.lack, 0
  %missing = call i64 @lacking(ptr %lane, ptr %span, i64 %all)
  %known = icmp sge i64 %missing, 0
  br i1 %known, label %enough.rows, label %python
enough.rows:
  %row.lacks = icmp sgt i64 %missing, 0
  %lacks = or i1 %row.lacks, %text.lacks
  br i1 %lacks, label %grow, label %begin
grow:
  %tried = add i64 %tries, 1
  %lane.at = call i64 @word(ptr %place, i64 56)
  %which = select i1 %row.lacks, i64 %lane.at, i64 %target.at
  %rows = select i1 %row.lacks, i64 %missing, i64 %text.lack
  %early = icmp slt i64 %tries, 3
  br i1 %early, label %ask, label %python
ask:
  %is.made = call i1 @make_room(ptr %self, ptr %place, i64 %which, i64 %rows)
  br i1 %is.made, label %made, label %python
made:
  %now.count = call i64 @word(ptr %list, i64 16)
  %now.items = call ptr @pointer(ptr %list, i64 24)
  %same.count = icmp eq i64 %now.count, %count
  br i1 %same.count, label %sum, label %python
sum:
  %longest = call i64 @word(ptr %place, i64 224)
  %now.total = call i64 @total_size(ptr %now.items, i64 %count, i64 %longest)
  %same.total = icmp eq i64 %now.total, %total
  br i1 %same.total, label %find.again, label %python
find.again:
  br label %find
begin:
  %begun = call i1 @begin_writing(ptr %self, ptr %place, ptr %row)
  br i1 %begun, label %resize, label %python
resize:
  %within = call i64 @word(ptr %place, i64 160)
  %old = call i64 @word(ptr %span, i64 8)
  %old.start = load i64, ptr %span
  %stride = call i64 @word(ptr %lane, i64 24)
  %old.rows = call ptr @element_row(ptr %lane, i64 %old.start)
  %target = call ptr @resized(ptr %state, ptr %lane, ptr %span, i64 %all)
  ; rows that stayed keep their old texts' places; the others have none
  %fewer = icmp slt i64 %all, %old
  %common = select i1 %fewer, i64 %all, i64 %old
  call void @waste_texts(ptr %state, ptr %texts, ptr %old.rows, i64 %stride, i64 %within, i64 %all, i64 %old)
  %kept.bytes = mul i64 %common, %stride
  %moved = icmp ne ptr %target, %old.rows
  %any = icmp sgt i64 %common, 0
  %copy = and i1 %moved, %any
  br i1 %copy, label %carry, label %zero
carry:
  call void @llvm.memmove.p0.p0.i64(ptr %target, ptr %old.rows, i64 %kept.bytes, i1 false)
  br label %zero
zero:
  %all.bytes = mul i64 %all, %stride
  %new.bytes = sub i64 %all.bytes, %kept.bytes
  %new.at = getelementptr i8, ptr %target, i64 %kept.bytes
  call void @llvm.memset.p0.i64(ptr %new.at, i8 0, i64 %new.bytes, i1 false)
  %items = call ptr @pointer(ptr %list, i64 24)
  br label %head
head:
  %index = phi i64 [ 0, %zero ], [ %next, %put ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %next = add i64 %index, 1
  %item.at = getelementptr ptr, ptr %items, i64 %index
  %item = load ptr, ptr %item.at
  %content = call { ptr, i64 } @bytes_of(ptr %item, ptr @PyUnicode_Type)
  %data = extractvalue { ptr, i64 } %content, 0
  %size = extractvalue { ptr, i64 } %content, 1
  br label %write
write:
  %element = add i64 %first, %index
  %distance = mul i64 %element, %stride
  %shift = add i64 %distance, %within
  %text.span = getelementptr i8, ptr %target, i64 %shift
  %text.start = load i64, ptr %text.span
  %text.count = call i64 @word(ptr %text.span, i64 8)
  %text.used = call i64 @word(ptr %texts, i64 16)
  %sound = call i1 @is_sound(i64 %text.start, i64 %text.count, i64 %text.used)
  br i1 %sound, label %put, label %mend
mend:
  store i64 0, ptr %text.span
  call void @put(ptr %text.span, i64 8, i64 0)
  br label %put
put:
  %text.at = call ptr @resized(ptr %state, ptr %texts, ptr %text.span, i64 %size)
  call void @llvm.memmove.p0.p0.i64(ptr %text.at, ptr %data, i64 %size, i1 false)
  br label %head
done:
  ret i1 true
python:
  ret i1 false
}

; Note that the texts of rows from one on to another are not referred to any more.
define internal void @waste_texts(ptr %state, ptr %texts, ptr %rows, i64 %stride, i64 %within, i64 %from, i64 %to) {
  br label %head
head:
  %row = phi i64 [ %from, %0 ], [ %next, %each ]
  %sum = phi i64 [ 0, %0 ], [ %added, %each ]
  %more = icmp slt i64 %row, %to
  br i1 %more, label %each, label %done
each:
  %next = add i64 %row, 1
  %distance = mul i64 %row, %stride
  %shift = add i64 %distance, %within
  %span = getelementptr i8, ptr %rows, i64 %shift
  %count = call i64 @word(ptr %span, i64 8)
  %added = add i64 %sum, %count
  br label %head
done:
  %any = icmp sgt i64 %sum, 0
  br i1 %any, label %note, label %end
note:
  call void @waste(ptr %state, ptr %texts, i64 %sum)
  br label %end
end:
  ret void
}

; extend_texts(sequence, list) -> bool: whether the texts of a list were appended to a sequence; else Python must do it. METH_FASTCALL.
define ptr @extend_texts(ptr %module, ptr %arguments, i64 %given) {
  %sequence = load ptr, ptr %arguments
  %list = call ptr @pointer(ptr %arguments, i64 8)
  %found = call { i64, i64 } @elements(ptr %sequence)
  %first = extractvalue { i64, i64 } %found, 1
  %known = icmp sge i64 %first, 0
  %is.list = call i1 @is_exactly(ptr %list, ptr @PyList_Type)
  %can = and i1 %known, %is.list
  br i1 %can, label %look, label %python
look:
  %message = call ptr @pointer(ptr %sequence, i64 32)
  %place = call ptr @pointer(ptr %sequence, i64 16)
  %kind = call i64 @word(ptr %place, i64 128)
  %is.utf8 = icmp eq i64 %kind, 2
  br i1 %is.utf8, label %measure, label %python
measure:
  %count = call i64 @word(ptr %list, i64 16)
  %items = call ptr @pointer(ptr %list, i64 24)
  %longest = call i64 @word(ptr %place, i64 224)
  %total = call i64 @total_size(ptr %items, i64 %count, i64 %longest)
  %good = icmp sge i64 %total, 0
  br i1 %good, label %write, label %python
write:
  %done = call i1 @write_texts(ptr %message, ptr %place, ptr %list, i64 %first, i64 %count, i64 %total)
  %answer = zext i1 %done to i8
  %said = call ptr @box_bool(i8 %answer)
  ret ptr %said
python:
  %no = call ptr @box_bool(i8 0)
  ret ptr %no
}
