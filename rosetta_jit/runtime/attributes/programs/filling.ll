; Many messages of one buffer into a batch that has room for them: what a decoder's `many` does between taking the batch's lanes and giving them back.

declare ptr @PyEval_SaveThread()
declare void @PyEval_RestoreThread(ptr)

; fill_rows(recipe, messages, offsets, state) -> how many messages there are, if all of them were decoded; else -1 - n, where n were, and where
; nothing was done 0 of them. It raises nothing: whoever calls it goes on from there in Python.
;
; The recipe are bytes with two words: the address of the program's `many` (`backends/entry/many.ll`), and how many lanes its holders have.
; The state is that of lanes which the caller has taken. Messages and offsets are whatever the user has given: what is no plain buffer of bytes,
; or no array of int64 with one dimension or with two rows, is left to Python, and so are more messages than the first lane has room for.
define ptr @fill_rows(ptr %module, ptr %arguments, i64 %given) {
  %data = alloca [80 x i8]
  %places = alloca [80 x i8]
  %messages = call ptr @pointer(ptr %arguments, i64 8)
  %offsets = call ptr @pointer(ptr %arguments, i64 16)
  %number = call ptr @pointer(ptr %arguments, i64 24)
  %converted = call { i64, i1 } @unbox_signed(ptr %number)
  %address = extractvalue { i64, i1 } %converted, 0
  %state = inttoptr i64 %address to ptr
  ; PyBUF_SIMPLE
  %opened = call i32 @PyObject_GetBuffer(ptr %messages, ptr %data, i32 0)
  %is.buffer = icmp eq i32 %opened, 0
  br i1 %is.buffer, label %measure, label %clear, !prof !0
measure:
  %size = call i64 @word(ptr %data, i64 16)
  %element = call i64 @word(ptr %data, i64 24)
  %are.bytes = icmp eq i64 %element, 1
  br i1 %are.bytes, label %open, label %close, !prof !0
open:
  ; PyBUF_FORMAT and PyBUF_ND
  %placed = call i32 @PyObject_GetBuffer(ptr %offsets, ptr %places, i32 12)
  %are.places = icmp eq i32 %placed, 0
  br i1 %are.places, label %look, label %unplaced, !prof !0
look:
  %found = call { i64, i64 } @number_of_places(ptr %places)
  %count = extractvalue { i64, i64 } %found, 0
  %apart = extractvalue { i64, i64 } %found, 1
  %capacity = call i64 @word(ptr %state, i64 144)
  %fit = icmp ule i64 %count, %capacity
  br i1 %fit, label %run, label %leave, !prof !0
run:
  %recipe = load ptr, ptr %arguments
  %many = call ptr @pointer(ptr %recipe, i64 32)
  %lanes = call i64 @word(ptr %recipe, i64 40)
  call void @empty_lanes(ptr %state, i64 %lanes, i64 %count)
  %bytes = load ptr, ptr %data
  %begins = load ptr, ptr %places
  %ends = getelementptr i8, ptr %begins, i64 %apart
  %thread = call ptr @PyEval_SaveThread()
  %done = call i64 %many(ptr %bytes, i64 %size, ptr %begins, ptr %ends, i64 0, i64 %count, ptr %state)
  call void @PyEval_RestoreThread(ptr %thread)
  %all = icmp eq i64 %done, %count
  %less = xor i64 %done, -1
  %result = select i1 %all, i64 %done, i64 %less
  br label %leave
leave:
  %after = phi i64 [ -1, %look ], [ %result, %run ]
  call void @PyBuffer_Release(ptr %places)
  br label %close
unplaced:
  call void @PyErr_Clear()
  br label %close
close:
  %answer = phi i64 [ -1, %measure ], [ -1, %unplaced ], [ %after, %leave ]
  call void @PyBuffer_Release(ptr %data)
  br label %give
clear:
  call void @PyErr_Clear()
  br label %give
give:
  %last = phi i64 [ -1, %clear ], [ %answer, %close ]
  %object = call ptr @PyLong_FromSsize_t(i64 %last)
  ret ptr %object
}

; Of a view with its format and shape: how many messages it has places of, and how many bytes the ends lie behind the begins; -1 if it has none.
define internal { i64, i64 } @number_of_places(ptr %view) alwaysinline {
  %format = call ptr @pointer(ptr %view, i64 40)
  %element = call i64 @word(ptr %view, i64 24)
  %is.wide = icmp eq i64 %element, 8
  %is.spelt = icmp ne ptr %format, null
  %can.be = and i1 %is.wide, %is.spelt
  br i1 %can.be, label %spell, label %none, !prof !0
spell:
  %letter = load i8, ptr %format
  %behind.at = getelementptr i8, ptr %format, i64 1
  switch i8 %letter, label %none [ i8 108, label %alone
                                   i8 113, label %alone ]
alone:
  %behind = load i8, ptr %behind.at
  %is.alone = icmp eq i8 %behind, 0
  br i1 %is.alone, label %shape, label %none, !prof !0
shape:
  %dimensions.at = getelementptr i8, ptr %view, i64 36
  %dimensions = load i32, ptr %dimensions.at
  %sizes = call ptr @pointer(ptr %view, i64 48)
  %rows = load i64, ptr %sizes
  switch i32 %dimensions, label %none [ i32 1, label %line
                                        i32 2, label %table ]
line:
  %messages = add i64 %rows, -1
  %of.line = insertvalue { i64, i64 } { i64 0, i64 8 }, i64 %messages, 0
  ret { i64, i64 } %of.line
table:
  %columns = call i64 @word(ptr %sizes, i64 8)
  %are.two = icmp eq i64 %rows, 2
  %known = select i1 %are.two, i64 %columns, i64 -1
  %apart = shl i64 %columns, 3
  %counted = insertvalue { i64, i64 } poison, i64 %known, 0
  %of.table = insertvalue { i64, i64 } %counted, i64 %apart, 1
  ret { i64, i64 } %of.table
none:
  ret { i64, i64 } { i64 -1, i64 0 }
}

; Lanes that are going to be filled, from their first row on; so many rows of the first one are there from the start. Nothing can be read until then.
define internal void @empty_lanes(ptr %state, i64 %lanes, i64 %count) alwaysinline {
  store i64 0, ptr %state
  call void @put(ptr %state, i64 72, i64 0)
  call void @put(ptr %state, i64 152, i64 %count)
  br label %head
head:
  %lane = phi i64 [ 1, %0 ], [ %next, %each ]
  %more = icmp slt i64 %lane, %lanes
  br i1 %more, label %each, label %done
each:
  %next = add i64 %lane, 1
  %from = shl i64 %lane, 5
  %used.at = add i64 %from, 152
  call void @put(ptr %state, i64 %used.at, i64 0)
  br label %head
done:
  ret void
}
