; Methods that serialise, as objects whose vectorcall is one of these. In a method (`attributes.methods`) lie: 24 the holder class, 32 what else is
; needed, 40 the program (null until there is one), 48 the Python function for all that is not the common case.

declare ptr @PyObject_VectorcallMethod(ptr, ptr, i64, ptr)
declare ptr @PyLong_FromSsize_t(i64)

; Whether a call has so many arguments, by position alone, and the method has a program.
define internal i1 @is_common(ptr %method, i64 %nargsf, ptr %names, i64 %wanted) alwaysinline {
  %count = and i64 %nargsf, 9223372036854775807
  %counted = icmp eq i64 %count, %wanted
  %unnamed = icmp eq ptr %names, null
  %program = call ptr @pointer(ptr %method, i64 40)
  %bound = icmp ne ptr %program, null
  %one = and i1 %counted, %unnamed
  %two = and i1 %one, %bound
  ret i1 %two
}

; Whether the first argument is a holder of exactly the method's class.
define internal i1 @is_own(ptr %method, ptr %arguments) alwaysinline {
  %holder = load ptr, ptr %arguments
  %class = call ptr @pointer(ptr %method, i64 24)
  %own = call i1 @is_exactly(ptr %holder, ptr %class)
  ret i1 %own
}

define internal ptr @leave_to_python(ptr %method, ptr %arguments, i64 %nargsf, ptr %names) noinline {
  %function = call ptr @pointer(ptr %method, i64 48)
  %count = and i64 %nargsf, 9223372036854775807
  %answer = call ptr @PyObject_Vectorcall(ptr %function, ptr %arguments, i64 %count, ptr %names)
  ret ptr %answer
}

; x.encode() -> bytes
define ptr @method_encode(ptr %method, ptr %arguments, i64 %nargsf, ptr %names) {
  %common = call i1 @is_common(ptr %method, i64 %nargsf, ptr %names, i64 1)
  br i1 %common, label %look, label %python, !prof !0
look:
  %own = call i1 @is_own(ptr %method, ptr %arguments)
  br i1 %own, label %run, label %python, !prof !0
run:
  %program = call ptr @pointer(ptr %method, i64 40)
  %bytes = call ptr @PyObject_Vectorcall(ptr %program, ptr %arguments, i64 1, ptr null)
  ret ptr %bytes
python:
  %answer = call ptr @leave_to_python(ptr %method, ptr %arguments, i64 %nargsf, ptr %names)
  ret ptr %answer
}

; x.serialize(file) -> None; 32 is the name of the file's method.
define ptr @method_write(ptr %method, ptr %arguments, i64 %nargsf, ptr %names) {
  %pair = alloca [2 x ptr]
  %common = call i1 @is_common(ptr %method, i64 %nargsf, ptr %names, i64 2)
  br i1 %common, label %look, label %python, !prof !0
look:
  %own = call i1 @is_own(ptr %method, ptr %arguments)
  br i1 %own, label %run, label %python, !prof !0
run:
  %program = call ptr @pointer(ptr %method, i64 40)
  %bytes = call ptr @PyObject_Vectorcall(ptr %program, ptr %arguments, i64 1, ptr null)
  %encoded = icmp ne ptr %bytes, null
  br i1 %encoded, label %write, label %failed, !prof !0
write:
  %file = call ptr @pointer(ptr %arguments, i64 8)
  store ptr %file, ptr %pair
  call void @put_pointer(ptr %pair, i64 8, ptr %bytes)
  %name = call ptr @pointer(ptr %method, i64 32)
  %written = call ptr @PyObject_VectorcallMethod(ptr %name, ptr %pair, i64 2, ptr null)
  call void @Py_DecRef(ptr %bytes)
  %good = icmp ne ptr %written, null
  br i1 %good, label %done, label %failed, !prof !0
done:
  call void @Py_DecRef(ptr %written)
  call void @Py_IncRef(ptr @_Py_NoneStruct)
  ret ptr @_Py_NoneStruct
failed:
  ret ptr null
python:
  %answer = call ptr @leave_to_python(ptr %method, ptr %arguments, i64 %nargsf, ptr %names)
  ret ptr %answer
}

; What the program makes of bytes and a holder: the holder, of which it gives a reference; null of an error.
define internal ptr @decode_into(ptr %method, ptr %message, ptr %holder) alwaysinline {
  %pair = alloca [2 x ptr]
  %program = call ptr @pointer(ptr %method, i64 40)
  store ptr %message, ptr %pair
  call void @put_pointer(ptr %pair, i64 8, ptr %holder)
  %decoded = call ptr @PyObject_Vectorcall(ptr %program, ptr %pair, i64 2, ptr null)
  ret ptr %decoded
}

; x.deserialize(message) -> x
define ptr @method_decode(ptr %method, ptr %arguments, i64 %nargsf, ptr %names) {
  %common = call i1 @is_common(ptr %method, i64 %nargsf, ptr %names, i64 2)
  br i1 %common, label %look, label %python, !prof !0
look:
  %own = call i1 @is_own(ptr %method, ptr %arguments)
  br i1 %own, label %run, label %python, !prof !0
run:
  %holder = load ptr, ptr %arguments
  %message = call ptr @pointer(ptr %arguments, i64 8)
  %decoded = call ptr @decode_into(ptr %method, ptr %message, ptr %holder)
  ret ptr %decoded
python:
  %answer = call ptr @leave_to_python(ptr %method, ptr %arguments, i64 %nargsf, ptr %names)
  ret ptr %answer
}

; x.ParseFromString(bytes) -> how many they are
define ptr @method_parse(ptr %method, ptr %arguments, i64 %nargsf, ptr %names) {
  %common = call i1 @is_common(ptr %method, i64 %nargsf, ptr %names, i64 2)
  br i1 %common, label %look, label %python, !prof !0
look:
  %own = call i1 @is_own(ptr %method, ptr %arguments)
  %message = call ptr @pointer(ptr %arguments, i64 8)
  %is.bytes = call i1 @is_exactly(ptr %message, ptr @PyBytes_Type)
  %can = and i1 %own, %is.bytes
  br i1 %can, label %run, label %python, !prof !0
run:
  %holder = load ptr, ptr %arguments
  %decoded = call ptr @decode_into(ptr %method, ptr %message, ptr %holder)
  %good = icmp ne ptr %decoded, null
  br i1 %good, label %done, label %failed, !prof !0
done:
  call void @Py_DecRef(ptr %decoded)
  %size = call i64 @word(ptr %message, i64 16)
  %object = call ptr @PyLong_FromSsize_t(i64 %size)
  ret ptr %object
failed:
  ret ptr null
python:
  %answer = call ptr @leave_to_python(ptr %method, ptr %arguments, i64 %nargsf, ptr %names)
  ret ptr %answer
}

; cls.FromString(bytes) -> a new holder; 32 makes an empty one.
define ptr @method_make(ptr %method, ptr %arguments, i64 %nargsf, ptr %names) {
  %common = call i1 @is_common(ptr %method, i64 %nargsf, ptr %names, i64 1)
  br i1 %common, label %look, label %python, !prof !0
look:
  %message = load ptr, ptr %arguments
  %is.bytes = call i1 @is_exactly(ptr %message, ptr @PyBytes_Type)
  br i1 %is.bytes, label %make, label %python, !prof !0
make:
  %maker = call ptr @pointer(ptr %method, i64 32)
  %holder = call ptr @PyObject_Vectorcall(ptr %maker, ptr null, i64 0, ptr null)
  %made = icmp ne ptr %holder, null
  br i1 %made, label %run, label %failed, !prof !0
run:
  %decoded = call ptr @decode_into(ptr %method, ptr %message, ptr %holder)
  call void @Py_DecRef(ptr %holder)
  ret ptr %decoded
failed:
  ret ptr null
python:
  %answer = call ptr @leave_to_python(ptr %method, ptr %arguments, i64 %nargsf, ptr %names)
  ret ptr %answer
}

; decode.to(message, class) -> a new object of the class; the program is a pair of the class that was asked for last, and what makes its objects.
define ptr @method_turn(ptr %method, ptr %arguments, i64 %nargsf, ptr %names) {
  %common = call i1 @is_common(ptr %method, i64 %nargsf, ptr %names, i64 2)
  br i1 %common, label %look, label %python, !prof !0
look:
  %pair = call ptr @pointer(ptr %method, i64 40)
  %known = call ptr @pointer(ptr %pair, i64 24)
  %class = call ptr @pointer(ptr %arguments, i64 8)
  %same = icmp eq ptr %class, %known
  br i1 %same, label %run, label %python, !prof !0
run:
  ; another thread may ask for another class meanwhile
  %maker = call ptr @pointer(ptr %pair, i64 32)
  call void @keep(ptr %maker)
  %made = call ptr @PyObject_Vectorcall(ptr %maker, ptr %arguments, i64 1, ptr null)
  call void @Py_DecRef(ptr %maker)
  ret ptr %made
python:
  %answer = call ptr @leave_to_python(ptr %method, ptr %arguments, i64 %nargsf, ptr %names)
  ret ptr %answer
}
