; What all entries share. The entries' own files follow this one in one module.
;
; The context is an array of pointers: 0 state, 1 holder, 2 slow path, 3 source cell, 4 the holder's type (`runtime.callable.Context`),
; and 5 the number of messages made. What the host tells of a message is in `told.ll`, or `untold.ll` where no kernel asks.
; The slow path is a Python callable for whatever is not the common case. It gets the same arguments, finds the kernel's result in word 9 of
; the state (`kernel.state.RESULT`) if the kernel has failed, and raises, or makes room and runs the kernel again.
;
; Offsets into CPython's objects, the same from 3.11 to 3.14 (Include/object.h, cpython/bytesobject.h, pybuffer.h). Any object: type 8. bytes:
; size 16, data 32. Py_buffer: buf 0, len 16, 80 bytes in all. Ours (runtime/callable.py): of a callable the context 72, of a holder its state 16.

@PyBytes_Type = external global i8
declare i32 @PyObject_GetBuffer(ptr, ptr, i32)
declare void @PyBuffer_Release(ptr)
declare ptr @PyObject_Vectorcall(ptr, ptr, i64, ptr)
declare ptr @PyMemoryView_FromObject(ptr)
declare ptr @PyBytes_FromStringAndSize(ptr, i64)
declare ptr @PyLong_FromSsize_t(i64)
declare i64 @PyLong_AsSsize_t(ptr)
declare ptr @PyErr_Occurred()
declare i32 @PyList_SetItem(ptr, i64, ptr)
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)
declare i64 @kernel(ptr, i64, i64, ptr, i64)
declare i64 @size(ptr, i64, i64, ptr, i64)

define internal ptr @context(ptr %self) alwaysinline {
  %at = getelementptr i8, ptr %self, i64 72
  %context = load ptr, ptr %at
  ret ptr %context
}

; How many positional arguments a call has, -1 if there are named ones. The top bit of nargsf says that args[-1] is free (PEP 590).
define internal i64 @positional(i64 %nargsf, ptr %names) alwaysinline {
  %count = and i64 %nargsf, 9223372036854775807
  %unnamed = icmp eq ptr %names, null
  %answer = select i1 %unnamed, i64 %count, i64 -1
  ret i64 %answer
}

define internal ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names) alwaysinline {
  %at = getelementptr ptr, ptr %context, i64 2
  %callable = load ptr, ptr %at
  %answer = call ptr @PyObject_Vectorcall(ptr %callable, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %answer
}

; The state of a holder of exactly the program's type, else null.
define internal ptr @state_of(ptr %context, ptr %holder) alwaysinline {
  %type.at = getelementptr i8, ptr %holder, i64 8
  %type = load ptr, ptr %type.at
  %expected.at = getelementptr ptr, ptr %context, i64 4
  %expected = load ptr, ptr %expected.at
  %mine = icmp eq ptr %type, %expected
  br i1 %mine, label %load, label %foreign
load:
  %state.at = getelementptr i8, ptr %holder, i64 16
  %state = load ptr, ptr %state.at
  ret ptr %state
foreign:
  ret ptr null
}

; Leave the result of a kernel that has failed for the slow path.
define internal void @note(i64 %result, ptr %state) alwaysinline {
  %result.at = getelementptr i64, ptr %state, i64 9
  store i64 %result, ptr %result.at
  ret void
}

!0 = !{!"branch_weights", i32 1048576, i32 1}
!1 = !{!"branch_weights", i32 8, i32 1}
