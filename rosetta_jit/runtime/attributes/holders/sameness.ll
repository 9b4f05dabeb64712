; Whether two messages are the same: two programs (`attributes.sameness`), one for the rows of each, are run side by side. An instruction has six
; words; what they mean stands there. The answer is 1 or 0, or -1 where Python must look.

declare i32 @memcmp(ptr, ptr, i64)

; same(one, other, program of one, program of other) -> True, False, or None where Python must look
define ptr @same(ptr %module, ptr %arguments, i64 %given) {
  %one = load ptr, ptr %arguments
  %other = call ptr @pointer(ptr %arguments, i64 8)
  %first.object = call ptr @pointer(ptr %arguments, i64 16)
  %second.object = call ptr @pointer(ptr %arguments, i64 24)
  %first = call { i64, i1 } @unbox_signed(ptr %first.object)
  %second = call { i64, i1 } @unbox_signed(ptr %second.object)
  %first.at = extractvalue { i64, i1 } %first, 0
  %second.at = extractvalue { i64, i1 } %second, 0
  %p = inttoptr i64 %first.at to ptr
  %q = inttoptr i64 %second.at to ptr
  %row.a = call ptr @row(ptr %one)
  %row.b = call ptr @row(ptr %other)
  %has.a = icmp ne ptr %row.a, null
  %has.b = icmp ne ptr %row.b, null
  %both = and i1 %has.a, %has.b
  br i1 %both, label %run, label %python
run:
  %state.a = call ptr @pointer(ptr %one, i64 16)
  %state.b = call ptr @pointer(ptr %other, i64 16)
  %answer = call i64 @same_row(ptr %p, ptr %q, ptr %state.a, ptr %state.b, ptr %row.a, ptr %row.b, i64 100)
  %known = icmp sge i64 %answer, 0
  br i1 %known, label %tell, label %python
tell:
  %bit = trunc i64 %answer to i8
  %object = call ptr @box_bool(i8 %bit)
  ret ptr %object
python:
  call void @Py_IncRef(ptr @_Py_NoneStruct)
  ret ptr @_Py_NoneStruct
}

define internal i64 @same_row(ptr %p, ptr %q, ptr %state.a, ptr %state.b, ptr %a, ptr %b, i64 %depth) noinline {
  %deep = icmp sle i64 %depth, 0
  br i1 %deep, label %unknown, label %head
head:
  %at = phi i64 [ 0, %0 ], [ %next, %again ]
  %x = getelementptr i8, ptr %p, i64 %at
  %y = getelementptr i8, ptr %q, i64 %at
  %op = load i64, ptr %x
  %its.op = load i64, ptr %y
  %alike = icmp eq i64 %op, %its.op
  br i1 %alike, label %choose, label %unknown
choose:
  %x.offset = call i64 @word(ptr %x, i64 8)
  %y.offset = call i64 @word(ptr %y, i64 8)
  %cell.a = getelementptr i8, ptr %a, i64 %x.offset
  %cell.b = getelementptr i8, ptr %b, i64 %y.offset
  switch i64 %op, label %unknown [ i64 0, label %same
                                   i64 1, label %cells
                                   i64 2, label %bit
                                   i64 3, label %case
                                   i64 4, label %when
                                   i64 5, label %leaf
                                   i64 6, label %rows ]
cells:
  %count = call i64 @word(ptr %x, i64 16)
  %its.count = call i64 @word(ptr %y, i64 16)
  %kind = call i64 @word(ptr %x, i64 24)
  %its.kind = call i64 @word(ptr %y, i64 24)
  %counts = icmp eq i64 %count, %its.count
  %kinds = icmp eq i64 %kind, %its.kind
  %comparable = and i1 %counts, %kinds
  br i1 %comparable, label %compare, label %unknown
compare:
  %equal = call i1 @same_cells(ptr %cell.a, ptr %cell.b, i64 %kind, i64 %count)
  br i1 %equal, label %again, label %different
bit:
  %mask.a = call i64 @word(ptr %x, i64 16)
  %mask.b = call i64 @word(ptr %y, i64 16)
  %bits.a = load i64, ptr %cell.a
  %bits.b = load i64, ptr %cell.b
  %masked.a = and i64 %bits.a, %mask.a
  %masked.b = and i64 %bits.b, %mask.b
  %is.a = icmp ne i64 %masked.a, 0
  %is.b = icmp ne i64 %masked.b, 0
  %agree = icmp eq i1 %is.a, %is.b
  br i1 %agree, label %bit.skip, label %different
bit.skip:
  %behind = call i64 @word(ptr %x, i64 24)
  %bit.more = select i1 %is.a, i64 0, i64 %behind
  br label %again
case:
  %case.a = load i64, ptr %cell.a
  %case.b = load i64, ptr %cell.b
  %one.case = icmp eq i64 %case.a, %case.b
  br i1 %one.case, label %again, label %different
when:
  %chosen = load i64, ptr %cell.a
  %number = call i64 @word(ptr %x, i64 16)
  %is.chosen = icmp eq i64 %chosen, %number
  %beyond = call i64 @word(ptr %x, i64 24)
  %when.more = select i1 %is.chosen, i64 0, i64 %beyond
  br label %again
leaf:
  %of.leaf = call i64 @same_leaf(ptr %x, ptr %y, ptr %state.a, ptr %state.b, ptr %cell.a, ptr %cell.b)
  br label %judge
rows:
  %of.rows = call i64 @same_elements(ptr %x, ptr %y, ptr %state.a, ptr %state.b, ptr %cell.a, ptr %cell.b, i64 %depth)
  br label %judge
judge:
  %found = phi i64 [ %of.leaf, %leaf ], [ %of.rows, %rows ]
  %go.on = icmp eq i64 %found, 1
  br i1 %go.on, label %again, label %stop
stop:
  ret i64 %found
again:
  %more = phi i64 [ 0, %compare ], [ %bit.more, %bit.skip ], [ 0, %case ], [ %when.more, %when ], [ 0, %judge ]
  %forward = add i64 %more, 48
  %next = add i64 %at, %forward
  br label %head
same:
  ret i64 1
different:
  ret i64 0
unknown:
  ret i64 -1
}

; Numbers that lie together: kind 0 are bytes, 1 booleans, 2 floats, 3 doubles; NaN is not the same as itself, and minus zero is zero.
define internal i1 @same_cells(ptr %a, ptr %b, i64 %kind, i64 %count) {
  switch i64 %kind, label %bytes [ i64 1, label %begin
                                   i64 2, label %begin
                                   i64 3, label %begin ]
bytes:
  %order = call i32 @memcmp(ptr %a, ptr %b, i64 %count)
  %equal = icmp eq i32 %order, 0
  ret i1 %equal
begin:
  br label %head
head:
  %index = phi i64 [ 0, %begin ], [ %next, %again ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %same
each:
  %next = add i64 %index, 1
  switch i64 %kind, label %double [ i64 1, label %bool
                                    i64 2, label %float ]
bool:
  %bool.a.at = getelementptr i8, ptr %a, i64 %index
  %bool.b.at = getelementptr i8, ptr %b, i64 %index
  %bool.a = load i8, ptr %bool.a.at
  %bool.b = load i8, ptr %bool.b.at
  %true.a = icmp ne i8 %bool.a, 0
  %true.b = icmp ne i8 %bool.b, 0
  %bools = icmp eq i1 %true.a, %true.b
  br i1 %bools, label %again, label %different
float:
  %float.a.at = getelementptr float, ptr %a, i64 %index
  %float.b.at = getelementptr float, ptr %b, i64 %index
  %float.a = load float, ptr %float.a.at
  %float.b = load float, ptr %float.b.at
  %floats = fcmp oeq float %float.a, %float.b
  br i1 %floats, label %again, label %different
double:
  %double.a.at = getelementptr double, ptr %a, i64 %index
  %double.b.at = getelementptr double, ptr %b, i64 %index
  %double.a = load double, ptr %double.a.at
  %double.b = load double, ptr %double.b.at
  %doubles = fcmp oeq double %double.a, %double.b
  br i1 %doubles, label %again, label %different
again:
  br label %head
same:
  ret i1 true
different:
  ret i1 false
}

; Where the content of a span begins; null where it is borrowed, or no rows of the lane.
define internal ptr @span_rows(ptr %state, ptr %span, i64 %lane.at) alwaysinline {
  %lane = getelementptr i8, ptr %state, i64 %lane.at
  %start = load i64, ptr %span
  %count = call i64 @word(ptr %span, i64 8)
  %used = call i64 @word(ptr %lane, i64 16)
  %stride = call i64 @word(ptr %lane, i64 24)
  %address = load ptr, ptr %lane
  %sound = call i1 @is_sound(i64 %start, i64 %count, i64 %used)
  %distance = mul i64 %start, %stride
  %at = getelementptr i8, ptr %address, i64 %distance
  %found = select i1 %sound, ptr %at, ptr null
  ret ptr %found
}

; Texts, bytes and arrays of numbers.
define internal i64 @same_leaf(ptr %x, ptr %y, ptr %state.a, ptr %state.b, ptr %span.a, ptr %span.b) {
  %lane.a = call i64 @word(ptr %x, i64 16)
  %lane.b = call i64 @word(ptr %y, i64 16)
  %a = call ptr @span_rows(ptr %state.a, ptr %span.a, i64 %lane.a)
  %b = call ptr @span_rows(ptr %state.b, ptr %span.b, i64 %lane.b)
  %has.a = icmp ne ptr %a, null
  %has.b = icmp ne ptr %b, null
  %kind = call i64 @word(ptr %x, i64 24)
  %its.kind = call i64 @word(ptr %y, i64 24)
  %kinds = icmp eq i64 %kind, %its.kind
  %one = and i1 %has.a, %has.b
  %can = and i1 %one, %kinds
  br i1 %can, label %measure, label %unknown
measure:
  %count.a = call i64 @word(ptr %span.a, i64 8)
  %count.b = call i64 @word(ptr %span.b, i64 8)
  %counts = icmp eq i64 %count.a, %count.b
  br i1 %counts, label %compare, label %different
compare:
  %bytes = call i64 @word(ptr %x, i64 32)
  %is.bytes = icmp eq i64 %kind, 0
  %each = select i1 %is.bytes, i64 %bytes, i64 1
  %cells = mul i64 %count.a, %each
  %equal = call i1 @same_cells(ptr %a, ptr %b, i64 %kind, i64 %cells)
  %answer = zext i1 %equal to i64
  ret i64 %answer
different:
  ret i64 0
unknown:
  ret i64 -1
}

; Arrays of anything else, maps, and messages in lanes of their own. Word 32 is the answer where their lengths differ, word 40 where an element does.
define internal i64 @same_elements(ptr %x, ptr %y, ptr %state.a, ptr %state.b, ptr %span.a, ptr %span.b, i64 %depth) {
  %lane.a = call i64 @word(ptr %x, i64 16)
  %lane.b = call i64 @word(ptr %y, i64 16)
  %a = call ptr @span_rows(ptr %state.a, ptr %span.a, i64 %lane.a)
  %b = call ptr @span_rows(ptr %state.b, ptr %span.b, i64 %lane.b)
  %has.a = icmp ne ptr %a, null
  %has.b = icmp ne ptr %b, null
  %can = and i1 %has.a, %has.b
  br i1 %can, label %measure, label %unknown
measure:
  %count = call i64 @word(ptr %span.a, i64 8)
  %count.b = call i64 @word(ptr %span.b, i64 8)
  %counts = icmp eq i64 %count, %count.b
  br i1 %counts, label %begin, label %uneven
begin:
  %p = call ptr @pointer(ptr %x, i64 24)
  %q = call ptr @pointer(ptr %y, i64 24)
  %stride.a.at = getelementptr i8, ptr %state.a, i64 %lane.a
  %stride.b.at = getelementptr i8, ptr %state.b, i64 %lane.b
  %stride.a = call i64 @word(ptr %stride.a.at, i64 24)
  %stride.b = call i64 @word(ptr %stride.b.at, i64 24)
  %less = sub i64 %depth, 1
  br label %head
head:
  %index = phi i64 [ 0, %begin ], [ %next, %again ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %same
each:
  %next = add i64 %index, 1
  %distance.a = mul i64 %index, %stride.a
  %distance.b = mul i64 %index, %stride.b
  %row.a = getelementptr i8, ptr %a, i64 %distance.a
  %row.b = getelementptr i8, ptr %b, i64 %distance.b
  %found = call i64 @same_row(ptr %p, ptr %q, ptr %state.a, ptr %state.b, ptr %row.a, ptr %row.b, i64 %less)
  switch i64 %found, label %unknown [ i64 0, label %different
                                      i64 1, label %again ]
again:
  br label %head
same:
  ret i64 1
uneven:
  %if.uneven = call i64 @word(ptr %x, i64 32)
  ret i64 %if.uneven
different:
  %if.different = call i64 @word(ptr %x, i64 40)
  ret i64 %if.different
unknown:
  ret i64 -1
}
