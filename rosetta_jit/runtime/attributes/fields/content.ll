; Fields whose content lies in a lane of its own: text, bytes, arrays of numbers.

@surrogateescape = private constant [16 x i8] c"surrogateescape\00"
declare ptr @PyUnicode_DecodeUTF8(ptr, i64, ptr)
declare ptr @PyBytes_FromStringAndSize(ptr, i64)
declare ptr @PyDict_GetItemWithError(ptr, ptr)
declare ptr @PySequence_GetSlice(ptr, i64, i64)

define ptr @get_utf8(ptr %self, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %text = call ptr @text(ptr %self, ptr %place, ptr null)
  ret ptr %text
}

define ptr @get_octets(ptr %self, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %text = call ptr @text(ptr %self, ptr %place, ptr @surrogateescape)
  ret ptr %text
}

define internal ptr @text(ptr %self, ptr %place, ptr %errors) noinline {
  %found = call { ptr, i64, i64 } @span(ptr %self, ptr %place)
  %data = extractvalue { ptr, i64, i64 } %found, 0
  %count = extractvalue { ptr, i64, i64 } %found, 2
  %there = icmp ne ptr %data, null
  br i1 %there, label %read, label %python, !prof !0
read:
  %object = call ptr @PyUnicode_DecodeUTF8(ptr %data, i64 %count, ptr %errors)
  ret ptr %object
python:
  %asked = call ptr @ask(ptr %self, ptr %place)
  ret ptr %asked
}

; No bytes may be the zeros of an array of fixed length.
define ptr @get_bytes(ptr %self, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %found = call { ptr, i64, i64 } @span(ptr %self, ptr %place)
  %data = extractvalue { ptr, i64, i64 } %found, 0
  %count = extractvalue { ptr, i64, i64 } %found, 2
  %there = icmp ne ptr %data, null
  %some = icmp ne i64 %count, 0
  %can = and i1 %there, %some
  br i1 %can, label %read, label %python, !prof !0
read:
  %object = call ptr @PyBytes_FromStringAndSize(ptr %data, i64 %count)
  ret ptr %object
python:
  %asked = call ptr @ask(ptr %self, ptr %place)
  ret ptr %asked
}

; The array that was given out last, if nobody has it any more and it shows the same rows; else a slice of the array that shows the whole lane,
; which the message's lanes keep in a dict (`runtime.cells.Arrays`).
;
; Of numpy's arrays (PyArrayObject): 16 data, 24 dimensions, 32 lengths, 40 strides, 56 type, 64 flags, 72 list of weak references.
define ptr @get_numbers(ptr %self, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %found = call { ptr, i64, i64 } @span(ptr %self, ptr %place)
  %data = extractvalue { ptr, i64, i64 } %found, 0
  %start = extractvalue { ptr, i64, i64 } %found, 1
  %count = extractvalue { ptr, i64, i64 } %found, 2
  %there = icmp ne ptr %data, null
  br i1 %there, label %measure, label %python, !prof !0
measure:
  %least = call i64 @word(ptr %place, i64 80)
  %enough = icmp uge i64 %count, %least
  br i1 %enough, label %remember, label %python, !prof !0
remember:
  %offset = call i64 @word(ptr %place, i64 64)
  %last = call ptr @pointer(ptr %self, i64 %offset)
  %has.last = icmp ne ptr %last, null
  br i1 %has.last, label %compare, label %look
compare:
  %same = call i1 @shows(ptr %last, ptr %data, i64 %count, ptr %place)
  br i1 %same, label %give, label %look
give:
  call void @keep(ptr %last)
  ret ptr %last
look:
  %lanes = call ptr @pointer(ptr %self, i64 88)
  %arrays = call ptr @pointer(ptr %lanes, i64 40)
  %shown = icmp ne ptr %arrays, null
  br i1 %shown, label %search, label %python, !prof !0
search:
  %key = call ptr @pointer(ptr %place, i64 72)
  %array = call ptr @PyDict_GetItemWithError(ptr %arrays, ptr %key)
  %is = icmp ne ptr %array, null
  br i1 %is, label %slice, label %python, !prof !0
slice:
  call void @keep(ptr %array)
  %end = add i64 %start, %count
  %object = call ptr @PySequence_GetSlice(ptr %array, i64 %start, i64 %end)
  call void @Py_DecRef(ptr %array)
  %is.made = icmp ne ptr %object, null
  br i1 %is.made, label %note, label %done
note:
  call void @drop(ptr %self, i64 %offset)
  call void @keep(ptr %object)
  call void @put_pointer(ptr %self, i64 %offset, ptr %object)
  br label %done
done:
  ret ptr %object
python:
  %asked = call ptr @ask(ptr %self, ptr %place)
  ret ptr %asked
}

; Whether an array that we gave out is nobody's any more, shows these rows, and is as it was.
define internal i1 @shows(ptr %array, ptr %data, i64 %count, ptr %place) noinline {
  %spare = call i1 @is_spare(ptr %array)
  %its.data = call ptr @pointer(ptr %array, i64 16)
  %same.data = icmp eq ptr %its.data, %data
  %dimensions.at = getelementptr i8, ptr %array, i64 24
  %dimensions = load i32, ptr %dimensions.at
  %flat = icmp eq i32 %dimensions, 1
  %one = and i1 %spare, %same.data
  %two = and i1 %one, %flat
  br i1 %two, label %look, label %no
look:
  %lengths = call ptr @pointer(ptr %array, i64 32)
  %length = load i64, ptr %lengths
  %same.length = icmp eq i64 %length, %count
  %strides = call ptr @pointer(ptr %array, i64 40)
  %stride = load i64, ptr %strides
  %wanted = call i64 @word(ptr %place, i64 208)
  %same.stride = icmp eq i64 %stride, %wanted
  %type = call ptr @pointer(ptr %array, i64 56)
  %wanted.type = call ptr @pointer(ptr %place, i64 216)
  %same.type = icmp eq ptr %type, %wanted.type
  %flags.at = getelementptr i8, ptr %array, i64 64
  %flags = load i32, ptr %flags.at
  %writable = and i32 %flags, 1024
  %can.write = icmp ne i32 %writable, 0
  %weak = call ptr @pointer(ptr %array, i64 72)
  %unseen = icmp eq ptr %weak, null
  %a = and i1 %same.length, %same.stride
  %b = and i1 %same.type, %can.write
  %c = and i1 %a, %b
  %d = and i1 %c, %unseen
  ret i1 %d
no:
  ret i1 false
}

; The content of a field, its first row and how many they are; null where Python must read it.
define internal { ptr, i64, i64 } @span(ptr %self, ptr %place) noinline {
  %row = call ptr @row(ptr %self)
  %has.row = icmp ne ptr %row, null
  br i1 %has.row, label %look, label %none, !prof !0
look:
  %present = call i1 @is_present(ptr %place, ptr %row)
  br i1 %present, label %read, label %none, !prof !0
read:
  %offset = load i64, ptr %place
  %lane = call ptr @lane_of(ptr %self, ptr %place)
  %span = getelementptr i8, ptr %row, i64 %offset
  %found = call { ptr, i64, i64 } @span_at(ptr %self, ptr %span, ptr %lane)
  ret { ptr, i64, i64 } %found
none:
  ret { ptr, i64, i64 } zeroinitializer
}

define internal { ptr, i64, i64 } @span_at(ptr %self, ptr %span, ptr %lane) alwaysinline {
  %start = load i64, ptr %span
  %count = call i64 @word(ptr %span, i64 8)
  %data = call ptr @content(ptr %self, ptr %lane, i64 %start, i64 %count)
  %one = insertvalue { ptr, i64, i64 } undef, ptr %data, 0
  %two = insertvalue { ptr, i64, i64 } %one, i64 %start, 1
  %three = insertvalue { ptr, i64, i64 } %two, i64 %count, 2
  ret { ptr, i64, i64 } %three
}
