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

