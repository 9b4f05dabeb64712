; Objects of other classes that are handed over as bytes (`attributes.handing`). In what does it lie: 16 a decoder, null where
; nothing is to be checked, 24 an encoder, null where the bytes
; are already what is wanted; 32 what makes a holder, 40 a function of the objects' own, 48 the Python function for all that is not the common case,
; 56 a holder that nobody uses just now, or null; 64 the class whose functions in C are known, or null, 80 and 88 these functions, which do the same
; as 40, and 96 an empty tuple.

; A holder filled from bytes, which nobody else has until `give_spare`; null of an error.
define internal ptr @filled(ptr %handing, ptr %bytes) {
  %pair = alloca [2 x ptr]
  %spare = call ptr @pointer(ptr %handing, i64 56)
  %has = icmp ne ptr %spare, null
  br i1 %has, label %take, label %new, !prof !0
take:
  call void @put_pointer(ptr %handing, i64 56, ptr null)
  br label %fill
new:
  %maker = call ptr @pointer(ptr %handing, i64 32)
  %made = call ptr @PyObject_Vectorcall(ptr %maker, ptr null, i64 0, ptr null)
  %is.made = icmp ne ptr %made, null
  br i1 %is.made, label %fill, label %failed
fill:
  %holder = phi ptr [ %spare, %take ], [ %made, %new ]
  store ptr %bytes, ptr %pair
  call void @put_pointer(ptr %pair, i64 8, ptr %holder)
  %decoder = call ptr @pointer(ptr %handing, i64 16)
  %decoded = call ptr @PyObject_Vectorcall(ptr %decoder, ptr %pair, i64 2, ptr null)
  %good = icmp ne ptr %decoded, null
  br i1 %good, label %done, label %drop, !prof !0
done:
  call void @Py_DecRef(ptr %decoded)
  ret ptr %holder
drop:
  call void @give_spare(ptr %handing, ptr %holder)
  br label %failed
failed:
  ret ptr null
}

; Keep a holder for the next object, unless another thread has given one back meanwhile.
define internal void @give_spare(ptr %handing, ptr %holder) {
  %spare = call ptr @pointer(ptr %handing, i64 56)
  %has = icmp ne ptr %spare, null
  br i1 %has, label %drop, label %keep
keep:
  call void @put_pointer(ptr %handing, i64 56, ptr %holder)
  ret void
drop:
  call void @Py_DecRef(ptr %holder)
  ret void
}

; What a function gives for one argument; null of an error.
define internal ptr @called(ptr %function, ptr %argument) alwaysinline {
  %one = alloca [1 x ptr]
  store ptr %argument, ptr %one
  %answer = call ptr @PyObject_Vectorcall(ptr %function, ptr %one, i64 1, ptr null)
  ret ptr %answer
}

define internal i1 @is_single(i64 %nargsf, ptr %names) alwaysinline {
  %count = and i64 %nargsf, 9223372036854775807
  %one = icmp eq i64 %count, 1
  %unnamed = icmp eq ptr %names, null
  %single = and i1 %one, %unnamed
  ret i1 %single
}

; The bytes of an object; null of an error. The function in C takes the object, a tuple of arguments and a dict of named ones.
define internal ptr @written(ptr %handing, ptr %object) alwaysinline {
  %class = call ptr @pointer(ptr %handing, i64 64)
  %known = call i1 @is_exactly(ptr %object, ptr %class)
  br i1 %known, label %quick, label %usual, !prof !0
quick:
  %write = call ptr @pointer(ptr %handing, i64 80)
  %none = call ptr @pointer(ptr %handing, i64 96)
  %bytes = call ptr %write(ptr %object, ptr %none, ptr null)
  ret ptr %bytes
usual:
  %function = call ptr @pointer(ptr %handing, i64 40)
  %others = call ptr @called(ptr %function, ptr %object)
  ret ptr %others
}

; An object of bytes; null of an error. The functions in C are what allocates an object (`tp_new`), and the method that reads bytes into one.
define internal ptr @read(ptr %handing, ptr %bytes) {
  %class = call ptr @pointer(ptr %handing, i64 64)
  %known = icmp ne ptr %class, null
  br i1 %known, label %quick, label %usual, !prof !0
quick:
  %allocate = call ptr @pointer(ptr %handing, i64 80)
  %none = call ptr @pointer(ptr %handing, i64 96)
  %object = call ptr %allocate(ptr %class, ptr %none, ptr null)
  %made = icmp ne ptr %object, null
  br i1 %made, label %merge, label %failed, !prof !0
merge:
  %merger = call ptr @pointer(ptr %handing, i64 88)
  %size = call ptr %merger(ptr %object, ptr %bytes)
  %merged = icmp ne ptr %size, null
  br i1 %merged, label %done, label %drop, !prof !0
done:
  call void @Py_DecRef(ptr %size)
  ret ptr %object
drop:
  call void @Py_DecRef(ptr %object)
  br label %failed
failed:
  ret ptr null
usual:
  %function = call ptr @pointer(ptr %handing, i64 40)
  %others = call ptr @called(ptr %function, ptr %bytes)
  ret ptr %others
}

; Whether the objects' own function decides alone.
define internal i1 @decides_alone(ptr %handing) alwaysinline {
  %decoder = call ptr @pointer(ptr %handing, i64 16)
  %alone = icmp eq ptr %decoder, null
  ret i1 %alone
}

; hand_in(object) -> bytes. Where nothing is to be encoded they are the object's own, if they can be decoded.
define ptr @hand_in(ptr %handing, ptr %arguments, i64 %nargsf, ptr %names) {
  %single = call i1 @is_single(i64 %nargsf, ptr %names)
  br i1 %single, label %write, label %python, !prof !0
write:
  %object = load ptr, ptr %arguments
  %bytes = call ptr @written(ptr %handing, ptr %object)
  %written = icmp ne ptr %bytes, null
  %alone = call i1 @decides_alone(ptr %handing)
  br i1 %alone, label %alone.bytes, label %check
alone.bytes:
  br i1 %written, label %done, label %refused, !prof !0
done:
  ret ptr %bytes
refused:
  call void @PyErr_Clear()
  br label %python
check:
  br i1 %written, label %fill, label %failed, !prof !0
fill:
  %holder = call ptr @filled(ptr %handing, ptr %bytes)
  %good = icmp ne ptr %holder, null
  br i1 %good, label %look, label %drop, !prof !0
look:
  %encoder = call ptr @pointer(ptr %handing, i64 24)
  %other = icmp ne ptr %encoder, null
  br i1 %other, label %encode, label %same
same:
  call void @give_spare(ptr %handing, ptr %holder)
  ret ptr %bytes
encode:
  call void @Py_DecRef(ptr %bytes)
  %encoded = call ptr @called(ptr %encoder, ptr %holder)
  call void @give_spare(ptr %handing, ptr %holder)
  ret ptr %encoded
drop:
  call void @Py_DecRef(ptr %bytes)
  br label %failed
failed:
  ret ptr null
python:
  %answer = call ptr @leave_to_python(ptr %handing, ptr %arguments, i64 %nargsf, ptr %names)
  ret ptr %answer
}

; hand_out(bytes) -> object. Where nothing is to be encoded it is made of the same bytes, once they have been decoded.
define ptr @hand_out(ptr %handing, ptr %arguments, i64 %nargsf, ptr %names) {
  %single = call i1 @is_single(i64 %nargsf, ptr %names)
  br i1 %single, label %look, label %python, !prof !0
look:
  %message = load ptr, ptr %arguments
  %is.bytes = call i1 @is_exactly(ptr %message, ptr @PyBytes_Type)
  br i1 %is.bytes, label %whose, label %python, !prof !0
whose:
  %alone = call i1 @decides_alone(ptr %handing)
  br i1 %alone, label %alone.object, label %fill
alone.object:
  %object = call ptr @read(ptr %handing, ptr %message)
  %accepted = icmp ne ptr %object, null
  br i1 %accepted, label %done, label %refused, !prof !0
done:
  ret ptr %object
refused:
  call void @PyErr_Clear()
  br label %python
fill:
  %holder = call ptr @filled(ptr %handing, ptr %message)
  %good = icmp ne ptr %holder, null
  br i1 %good, label %sort, label %failed, !prof !0
sort:
  %encoder = call ptr @pointer(ptr %handing, i64 24)
  %other = icmp ne ptr %encoder, null
  br i1 %other, label %encode, label %same
same:
  call void @give_spare(ptr %handing, ptr %holder)
  %own = call ptr @read(ptr %handing, ptr %message)
  ret ptr %own
encode:
  %bytes = call ptr @called(ptr %encoder, ptr %holder)
  call void @give_spare(ptr %handing, ptr %holder)
  %encoded = icmp ne ptr %bytes, null
  br i1 %encoded, label %read.bytes, label %failed, !prof !0
read.bytes:
  %made = call ptr @read(ptr %handing, ptr %bytes)
  call void @Py_DecRef(ptr %bytes)
  ret ptr %made
failed:
  ret ptr null
python:
  %answer = call ptr @leave_to_python(ptr %handing, ptr %arguments, i64 %nargsf, ptr %names)
  ret ptr %answer
}
