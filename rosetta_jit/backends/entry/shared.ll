; What all entries share. The entries' own files follow this one in one module.
;
; The context is an array of pointers: 0 state, 1 holder, 2 slow path, 3 source cell, 4 the holder's type (`runtime.callable.Context`; until there
; is a holder of the program's own, 0 is a state that is in use), 5 the number of messages made, 6 the thread of the program's own holder,
; 7 the registers, 8 whether a kernel for one of several wires has failed, 9 of an encoder, objects of which other class go where
; (`any_encode.ll`), 10 a list with the number that it last gave, 11 that number. A message gets its time and its number in
; `time_and_number.ll`, or `no_time_or_number.ll` where no kernel asks; what kernels keep for the next message is in `registers.ll`, or
; `no_registers.ll`. Who may use the program's own holder is asked in `thread_check.ll`.
; Who changes lanes in a way that another thread can interrupt makes word 1 of their state negative (`kernel.state.EPOCH`): then entries leave
; them to the slow path, which refuses. An entry itself has the interpreter lock; where its kernel may let it go is said in `hosted.ll`.
; The slow path is a Python callable for whatever is not the common case. It gets the same arguments, finds the kernel's result in word 9 of
; the state (`kernel.state.RESULT`) if the kernel has failed, and raises, or makes room and runs the kernel again.
; What is hardly ever called is `cold`, and `optnone`, so that LLVM does not take more time for it than for all that is called.
;
; Offsets into CPython's objects, the same from 3.11 to 3.14 (Include/object.h, cpython/bytesobject.h, cpython/bytearrayobject.h, pybuffer.h).
; Any object: type 8. bytes: size 16, data 32. list: items 24. bytearray: size 16, data 40, how often its buffer is exported 48. Py_buffer: buf 0, len 16, itemsize 24, 80
; bytes in all. Ours (runtime/callable.py): of a callable the context 72, of a holder its state 16.

@PyBytes_Type = external global i8
@PyByteArray_Type = external global i8
declare i32 @PyObject_GetBuffer(ptr, ptr, i32)
declare void @PyBuffer_Release(ptr)
declare ptr @PyObject_Vectorcall(ptr, ptr, i64, ptr)
declare ptr @PyMemoryView_FromObject(ptr)
declare ptr @PyBytes_FromStringAndSize(ptr, i64)
declare ptr @PyLong_FromSsize_t(i64)
declare i64 @PyLong_AsSsize_t(ptr)
declare ptr @PyErr_Occurred()
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)
declare i64 @kernel(ptr, i64, i64, ptr, i64)
declare i64 @size(ptr, i64, i64, ptr, i64)

define internal ptr @context(ptr %self) alwaysinline {
  %at = getelementptr i8, ptr %self, i64 72
  %context = load ptr, ptr %at
  ret ptr %context
}

; How often the lanes of a state have changed, negative if they are in use.
define internal i64 @epoch(ptr %state) alwaysinline {
  %at = getelementptr i64, ptr %state, i64 1
  %epoch = load i64, ptr %at
  ret i64 %epoch
}

; How many positional arguments a call has, -1 if there are named ones. The top bit of nargsf says that args[-1] is free (PEP 590).
define internal i64 @positional(i64 %nargsf, ptr %names) alwaysinline {
  %count = and i64 %nargsf, 9223372036854775807
  %unnamed = icmp eq ptr %names, null
  %answer = select i1 %unnamed, i64 %count, i64 -1
  ret i64 %answer
}

; Whether a call has one positional argument and nothing else. No call has 2^32 of them, so that half a word says it.
define internal i1 @is_alone(i64 %nargsf, ptr %names) alwaysinline {
  %low = trunc i64 %nargsf to i32
  %single = icmp eq i32 %low, 1
  %unnamed = icmp eq ptr %names, null
  %answer = and i1 %single, %unnamed
  ret i1 %answer
}

define internal ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names) alwaysinline {
  %at = getelementptr ptr, ptr %context, i64 2
  %callable = load ptr, ptr %at
  %answer = tail call ptr @PyObject_Vectorcall(ptr %callable, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %answer
}

; The state of a holder of exactly the program's type, else null.
define internal ptr @state_of(ptr %context, ptr %holder) alwaysinline {
  %mine = call i1 @is_of_type(ptr %context, ptr %holder)
  br i1 %mine, label %load, label %foreign
load:
  %state = call ptr @state_in(ptr %holder)
  ret ptr %state
foreign:
  ret ptr null
}

; Whether an object is of exactly the program's type of holders.
define internal i1 @is_of_type(ptr %context, ptr %object) alwaysinline {
  %type.at = getelementptr i8, ptr %object, i64 8
  %type = load ptr, ptr %type.at
  %expected.at = getelementptr ptr, ptr %context, i64 4
  %expected = load ptr, ptr %expected.at
  %same = icmp eq ptr %type, %expected
  ret i1 %same
}

; The state of a holder; null if it has none yet.
define internal ptr @state_in(ptr %holder) alwaysinline {
  %state.at = getelementptr i8, ptr %holder, i64 16
  %state = load ptr, ptr %state.at
  ret ptr %state
}

; Export an object's buffer into the view; false if an error is set. Of a bytearray we do ourselves what it would do, in a fifth of the time,
; and of the view fill only buf and len.
define internal i1 @open(ptr %object, ptr %view, i32 %flags) alwaysinline {
  %is_array = call i1 @is_array(ptr %object)
  br i1 %is_array, label %array, label %any, !prof !1
array:
  call void @count_exports(ptr %object, i64 1)
  %data.at = getelementptr i8, ptr %object, i64 40
  %data = load ptr, ptr %data.at
  store ptr %data, ptr %view
  %size.at = getelementptr i8, ptr %object, i64 16
  %size = load i64, ptr %size.at
  %view.size.at = getelementptr i8, ptr %view, i64 16
  store i64 %size, ptr %view.size.at
  ret i1 true
any:
  %got = call i32 @PyObject_GetBuffer(ptr %object, ptr %view, i32 %flags)
  %has = icmp eq i32 %got, 0
  ret i1 %has
}

; Export the buffer of a message: 1; 0 where references to objects are in it, which the slow path refuses; -1 if an error is set. Elements of one byte
; are no references.
define internal i32 @open_message(ptr %object, ptr %view) alwaysinline {
  %has = call i1 @open(ptr %object, ptr %view, i32 0)
  br i1 %has, label %opened, label %raise, !prof !0
opened:
  %is_array = call i1 @is_array(ptr %object)
  br i1 %is_array, label %good, label %measure, !prof !1
measure:
  %element.at = getelementptr i8, ptr %view, i64 24
  %element.size = load i64, ptr %element.at
  %is.byte = icmp eq i64 %element.size, 1
  br i1 %is.byte, label %good, label %look, !prof !0
look:
  %found = call i32 @open_with_format(ptr %object, ptr %view)
  ret i32 %found
good:
  ret i32 1
raise:
  ret i32 -1
}

; The same of a view that has elements of more bytes. It is exported again with its format, which numpy puts together whenever it is asked.
define internal i32 @open_with_format(ptr %object, ptr %view) noinline cold optnone {
  call void @PyBuffer_Release(ptr %view)
  ; PyBUF_FORMAT and PyBUF_ND
  %got = call i32 @PyObject_GetBuffer(ptr %object, ptr %view, i32 12)
  %has = icmp eq i32 %got, 0
  br i1 %has, label %look, label %raise
look:
  %plain = call i1 @holds_no_objects(ptr %object, ptr %view)
  br i1 %plain, label %good, label %refuse
refuse:
  call void @PyBuffer_Release(ptr %view)
  ret i32 0
good:
  ret i32 1
raise:
  ret i32 -1
}

; Whether what was exported are bytes and numbers, and no references to objects: their format is as `struct` and numpy have it.
; A name in it may have the letter, too: the slow path looks more closely.
define internal i1 @holds_no_objects(ptr %object, ptr %view) alwaysinline {
entry:
  %is_array = call i1 @is_array(ptr %object)
  br i1 %is_array, label %yes, label %any, !prof !1
any:
  %format.at = getelementptr i8, ptr %view, i64 40
  %format = load ptr, ptr %format.at
  %has.format = icmp ne ptr %format, null
  br i1 %has.format, label %look, label %yes, !prof !0
look:
  %at = phi ptr [ %format, %any ], [ %next, %go.on ]
  %letter = load i8, ptr %at
  switch i8 %letter, label %go.on [ i8 0, label %yes
                                    i8 79, label %no ]
go.on:
  %next = getelementptr i8, ptr %at, i64 1
  br label %look
yes:
  ret i1 true
no:
  ret i1 false
}

define internal void @close(ptr %object, ptr %view) alwaysinline {
  %is_array = call i1 @is_array(ptr %object)
  br i1 %is_array, label %array, label %any, !prof !1
array:
  call void @count_exports(ptr %object, i64 -1)
  ret void
any:
  call void @PyBuffer_Release(ptr %view)
  ret void
}

define internal i1 @is_array(ptr %object) alwaysinline {
  %type.at = getelementptr i8, ptr %object, i64 8
  %type = load ptr, ptr %type.at
  %is_array = icmp eq ptr %type, @PyByteArray_Type
  ret i1 %is_array
}

; While a bytearray is exported it cannot be resized.
define internal void @count_exports(ptr %array, i64 %more) alwaysinline {
  %exports.at = getelementptr i8, ptr %array, i64 48
  %exports = load i64, ptr %exports.at
  %counted = add i64 %exports, %more
  store i64 %counted, ptr %exports.at
  ret void
}

; One more reference to an object of ours, which is not immortal.
define internal void @keep(ptr %object) alwaysinline {
  %count = load i64, ptr %object
  %more = add i64 %count, 1
  store i64 %more, ptr %object
  ret void
}

; One more reference to any object, and one less. CPython does it itself where the count may stand for more than a count, as that of an immortal
; object, or where the reference is the last one. What is kept is given back, so that it need not outlive a call.
define internal ptr @keep_any(ptr %object) alwaysinline {
  %count = load i64, ptr %object
  %plain = icmp ult i64 %count, 1073741824
  br i1 %plain, label %here, label %there, !prof !0
here:
  %more = add i64 %count, 1
  store i64 %more, ptr %object
  br label %done
there:
  %counted = call ptr @counted_by_python(ptr %object)
  br label %done
done:
  %kept = phi ptr [ %object, %here ], [ %counted, %there ]
  ret ptr %kept
}

define internal ptr @counted_by_python(ptr %object) noinline cold optnone {
  call void @Py_IncRef(ptr %object)
  ret ptr %object
}

define internal void @drop_any(ptr %object) alwaysinline {
  %count = load i64, ptr %object
  %less = add i64 %count, -1
  %others = add i64 %count, -2
  %plain = icmp ult i64 %others, 1073741824
  br i1 %plain, label %here, label %there
here:
  store i64 %less, ptr %object
  ret void
there:
  call void @Py_DecRef(ptr %object)
  ret void
}

; Leave the result of a kernel that has failed for the slow path.
define internal void @note(i64 %result, ptr %state) alwaysinline {
  %result.at = getelementptr i64, ptr %state, i64 9
  store i64 %result, ptr %result.at
  ret void
}

!0 = !{!"branch_weights", i32 1048576, i32 1}
!1 = !{!"branch_weights", i32 8, i32 1}
!2 = !{!"branch_weights", i32 1, i32 1048576, i32 1}
