; Assignment to fields whose content lies in a lane of its own, by values of exactly the common types: str, bytes, lists of numbers or of texts, arrays.
;
; New content is written where the old one lies if it is as long, or ends its lane; else behind the lane's last row, and the old rows are wasted
; (word 15 of the state): where that is much, the next encode tidies up. Fewer rows at the end are given back only where no other span refers to the
; lane, which might be empty and begin behind them. Whether there is room is asked first. Where there is none, Python makes it;
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

; Give a span so many rows, for which there is room; where they begin. What they hold is not kept. `%around` are the words of the lane that has the span.
define internal ptr @resized(ptr %state, ptr %around, ptr %lane, ptr %span, i64 %count) {
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
  %rows.around = call i64 @word(ptr %around, i64 16)
  %is.alone = icmp eq i64 %rows.around, 1
  %is.more = icmp sgt i64 %count, %old
  %may.end = or i1 %is.alone, %is.more
  %ends.here = and i1 %at.end, %may.end
  br i1 %ends.here, label %here, label %elsewhere
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

; The bytes of exactly a str, as UTF-8, or of exactly a bytes object; null if it is none, or has no UTF-8. Those of a str of ASCII lie behind its head.
define internal { ptr, i64 } @bytes_of(ptr %value, ptr %type) alwaysinline {
  %size.at = alloca i64
  %is = call i1 @is_exactly(ptr %value, ptr %type)
  br i1 %is, label %look, label %none
look:
  %is.text = icmp eq ptr %type, @PyUnicode_Type
  br i1 %is.text, label %flags, label %raw
flags:
  %state.at = getelementptr i8, ptr %value, i64 32
  %text.state = load i32, ptr %state.at
  %text.kind = and i32 %text.state, $ASCII_FLAGS
  %is.ascii = icmp eq i32 %text.kind, $ASCII_KIND
  br i1 %is.ascii, label %ascii, label %text, !prof !0
ascii:
  %characters = getelementptr i8, ptr %value, i64 $ASCII_BYTES
  %character.count = call i64 @word(ptr %value, i64 16)
  br label %none
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
  %at = phi ptr [ null, %0 ], [ null, %wrong ], [ %utf8, %measure ], [ %data, %raw ], [ %characters, %ascii ]
  %count = phi i64 [ 0, %0 ], [ 0, %wrong ], [ %size, %measure ], [ %length, %raw ], [ %character.count, %ascii ]
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
  %around = call ptr @own_lane(ptr %self)
  %target = call ptr @resized(ptr %state, ptr %around, ptr %lane, ptr %span, i64 %count)
  ret ptr %target
python:
  ret ptr null
}

