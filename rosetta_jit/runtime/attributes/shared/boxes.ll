; Python's numbers, made and read. What is read must be of exactly the type; a subclass may do anything.

@PyFloat_Type = external global i8
@PyLong_Type = external global i8
@_Py_TrueStruct = external global i8
@_Py_FalseStruct = external global i8
declare ptr @PyFloat_FromDouble(double)
declare ptr @PyLong_FromLongLong(i64)
declare ptr @PyLong_FromUnsignedLongLong(i64)
declare i64 @PyLong_AsLongLongAndOverflow(ptr, ptr)

define internal i1 @is_exactly(ptr %object, ptr %type) alwaysinline {
  %its = call ptr @pointer(ptr %object, i64 8)
  %is = icmp eq ptr %its, %type
  ret i1 %is
}

; The floats that were given out last, and the place of the last one among them. One that nobody else has any more is given out again with another
; value, as CPython does with the tuples of `zip`: a loop that reads numbers and drops them takes no memory, and gives none back.
@floats = internal global [8 x ptr] zeroinitializer
@floats.last = internal global i64 0

define internal ptr @box_float(double %value) alwaysinline {
  %last = load i64, ptr @floats.last
  %next = add i64 %last, 1
  %index = and i64 %next, 7
  store i64 %index, ptr @floats.last
  %place = getelementptr ptr, ptr @floats, i64 %index
  %before = load ptr, ptr %place
  %has = icmp ne ptr %before, null
  br i1 %has, label %look, label %new, !prof !0
look:
  %spare = call i1 @is_spare(ptr %before)
  br i1 %spare, label %again, label %new
again:
  call void @keep(ptr %before)
  %value.at = getelementptr i8, ptr %before, i64 16
  store double %value, ptr %value.at
  ret ptr %before
new:
  %made = call ptr @new_float(double %value, ptr %place)
  ret ptr %made
}

; A new float, which takes the place of one that somebody has kept; null of an error.
define internal ptr @new_float(double %value, ptr %place) noinline {
  %object = call ptr @PyFloat_FromDouble(double %value)
  %made = icmp ne ptr %object, null
  br i1 %made, label %remember, label %done
remember:
  call void @keep(ptr %object)
  %before = load ptr, ptr %place
  store ptr %object, ptr %place
  %has = icmp ne ptr %before, null
  br i1 %has, label %forget, label %done
forget:
  call void @Py_DecRef(ptr %before)
  br label %done
done:
  ret ptr %object
}

define internal ptr @box_bool(i8 %value) alwaysinline {
  %is = icmp ne i8 %value, 0
  %object = select i1 %is, ptr @_Py_TrueStruct, ptr @_Py_FalseStruct
  call void @Py_IncRef(ptr %object)
  ret ptr %object
}

; A float has its value behind the header.
define internal { double, i1 } @unbox_float(ptr %object) alwaysinline {
  %is = call i1 @is_exactly(ptr %object, ptr @PyFloat_Type)
  br i1 %is, label %read, label %no
read:
  %at = getelementptr i8, ptr %object, i64 16
  %value = load double, ptr %at
  br label %no
no:
  %found = phi double [ 0.0, %0 ], [ %value, %read ]
  %one = insertvalue { double, i1 } undef, double %found, 0
  %result = insertvalue { double, i1 } %one, i1 %is, 1
  ret { double, i1 } %result
}

define internal { i64, i1 } @unbox_signed(ptr %object) alwaysinline {
  %overflow = alloca i32
  %is = call i1 @is_exactly(ptr %object, ptr @PyLong_Type)
  br i1 %is, label %look, label %no
look:
  %digit = call { i64, i1 } @one_digit(ptr %object)
  %short = extractvalue { i64, i1 } %digit, 0
  %is.short = extractvalue { i64, i1 } %digit, 1
  br i1 %is.short, label %no, label %read
read:
  %value = call i64 @PyLong_AsLongLongAndOverflow(ptr %object, ptr %overflow)
  %over = load i32, ptr %overflow
  %fits = icmp eq i32 %over, 0
  br label %no
no:
  %found = phi i64 [ 0, %0 ], [ %short, %look ], [ %value, %read ]
  %good = phi i1 [ false, %0 ], [ true, %look ], [ %fits, %read ]
  %one = insertvalue { i64, i1 } undef, i64 %found, 0
  %result = insertvalue { i64, i1 } %one, i1 %good, 1
  ret { i64, i1 } %result
}

; A float, or an integer as a float.
define internal { double, i1 } @unbox_real(ptr %object) {
  %is = call i1 @is_exactly(ptr %object, ptr @PyFloat_Type)
  br i1 %is, label %float, label %integer
float:
  %found = call { double, i1 } @unbox_float(ptr %object)
  ret { double, i1 } %found
integer:
  %whole = call { i64, i1 } @unbox_signed(ptr %object)
  %number = extractvalue { i64, i1 } %whole, 0
  %good = extractvalue { i64, i1 } %whole, 1
  %real = sitofp i64 %number to double
  %one = insertvalue { double, i1 } undef, double %real, 0
  %result = insertvalue { double, i1 } %one, i1 %good, 1
  ret { double, i1 } %result
}

; What has its highest bit set is left to Python.
define internal { i64, i1 } @unbox_unsigned(ptr %object) alwaysinline {
  %signed = call { i64, i1 } @unbox_signed(ptr %object)
  %value = extractvalue { i64, i1 } %signed, 0
  %is = extractvalue { i64, i1 } %signed, 1
  %positive = icmp sge i64 %value, 0
  %good = and i1 %is, %positive
  %result = insertvalue { i64, i1 } %signed, i1 %good, 1
  ret { i64, i1 } %result
}

define internal { i8, i1 } @unbox_bool(ptr %object) alwaysinline {
  %true = icmp eq ptr %object, @_Py_TrueStruct
  %false = icmp eq ptr %object, @_Py_FalseStruct
  %is = or i1 %true, %false
  %value = zext i1 %true to i8
  %one = insertvalue { i8, i1 } undef, i8 %value, 0
  %result = insertvalue { i8, i1 } %one, i1 %is, 1
  ret { i8, i1 } %result
}
