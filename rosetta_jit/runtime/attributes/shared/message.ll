; What all accessors share: the words of a message, of a place, and of the state.
;
; Offsets into a message (`runtime.callable`): 16 state, 24 row, 32 epoch at which the row was found, 40 its lane's words in the state,
; 48 places of its record, 56 index, 64 its span in the parent's row; and objects (`holder.message`): 72 access, 80 entry, 88 lanes, 96 parent,
; $MESSAGE_WEAK_LIST list of weak references, $MESSAGE_END the first slot of its own class. Offsets into a place are those of `attributes.places.Place`.
; Of the state (`kernel.state`): 0 valid, 8 epoch; of a lane's words: 0 address, 8 capacity, 16 used rows, 24 bytes of a row.
;
; An accessor does the common case and asks a Python function for every other: the place has one that reads and one that writes. It has the
; interpreter lock from begin to end, and calls nothing between finding a row and using it that could run other code.

@PyExc_AttributeError = external global ptr
@never.made = private constant [52 x i8] c"this message was never made: its __init__ never ran\00"
declare ptr @PyObject_Vectorcall(ptr, ptr, i64, ptr)
declare void @PyErr_SetString(ptr, ptr)
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)

define internal ptr @pointer(ptr %object, i64 %offset) alwaysinline {
  %at = getelementptr i8, ptr %object, i64 %offset
  %found = load ptr, ptr %at
  ret ptr %found
}

define internal i64 @word(ptr %object, i64 %offset) alwaysinline {
  %at = getelementptr i8, ptr %object, i64 %offset
  %found = load i64, ptr %at
  ret i64 %found
}

define internal void @put(ptr %object, i64 %offset, i64 %value) alwaysinline {
  %at = getelementptr i8, ptr %object, i64 %offset
  store i64 %value, ptr %at
  ret void
}

define internal void @put_pointer(ptr %object, i64 %offset, ptr %value) alwaysinline {
  %at = getelementptr i8, ptr %object, i64 %offset
  store ptr %value, ptr %at
  ret void
}

; One more reference to an object, if there is one; none of these is immortal, as None is.
define internal void @keep(ptr %object) alwaysinline {
  %is = icmp ne ptr %object, null
  br i1 %is, label %count, label %done
count:
  %references = load i64, ptr %object
  %more = add i64 %references, 1
  store i64 %more, ptr %object
  br label %done
done:
  ret void
}

; The place of a field, null of a message that was never made. `%field` is the offset among the places of its record.
define internal ptr @place(ptr %self, ptr %field) alwaysinline {
  %table = call ptr @pointer(ptr %self, i64 48)
  %offset = ptrtoint ptr %field to i64
  %at = getelementptr i8, ptr %table, i64 %offset
  %made = icmp ne ptr %table, null
  %place = select i1 %made, ptr %at, ptr null
  ret ptr %place
}

; Where the row of a message begins; null where Python must say why it cannot be read.
define internal ptr @row(ptr %self) noinline {
  %state = call ptr @pointer(ptr %self, i64 16)
  %is.made = icmp ne ptr %state, null
  br i1 %is.made, label %look, label %none, !prof !0
look:
  %valid = load i64, ptr %state
  %is.valid = icmp ne i64 %valid, 0
  br i1 %is.valid, label %valid.state, label %none, !prof !0
valid.state:
  %epoch = call i64 @word(ptr %state, i64 8)
  %found = call i64 @word(ptr %self, i64 32)
  %current = icmp eq i64 %found, %epoch
  %fixed = icmp eq i64 %found, -9223372036854775808
  %known = or i1 %current, %fixed
  %free = icmp sge i64 %epoch, 0
  %easy = and i1 %known, %free
  br i1 %easy, label %take, label %search, !prof !0
search:
  %again = call i1 @find(ptr %self, i64 100)
  br i1 %again, label %take, label %none, !prof !0
take:
  %row = call ptr @row_found(ptr %self, ptr %state)
  ret ptr %row
none:
  ret ptr null
}

; The same with the common case as part of the caller.
define internal ptr @row_at_once(ptr %self) alwaysinline {
  %state = call ptr @pointer(ptr %self, i64 16)
  %is.made = icmp ne ptr %state, null
  br i1 %is.made, label %look, label %search, !prof !0
look:
  %valid = load i64, ptr %state
  %epoch = call i64 @word(ptr %state, i64 8)
  %found = call i64 @word(ptr %self, i64 32)
  %is.valid = icmp ne i64 %valid, 0
  %current = icmp eq i64 %found, %epoch
  %fixed = icmp eq i64 %found, -9223372036854775808
  %known = or i1 %current, %fixed
  %free = icmp sge i64 %epoch, 0
  %one = and i1 %is.valid, %known
  %easy = and i1 %one, %free
  br i1 %easy, label %take, label %search, !prof !0
take:
  %quick = call ptr @row_found(ptr %self, ptr %state)
  ret ptr %quick
search:
  %row = call ptr @row(ptr %self)
  ret ptr %row
}

; Where the row begins that was found; null if it is not in use.
define internal ptr @row_found(ptr %self, ptr %state) alwaysinline {
  %lane.at = call i64 @word(ptr %self, i64 40)
  %lane = getelementptr i8, ptr %state, i64 %lane.at
  %row = call i64 @word(ptr %self, i64 24)
  %address = call ptr @element_row(ptr %lane, i64 %row)
  ret ptr %address
}

; Where a row of a lane begins; null if it is not in use.
define internal ptr @element_row(ptr %lane, i64 %row) alwaysinline {
  %address = load ptr, ptr %lane
  %used = call i64 @word(ptr %lane, i64 16)
  %stride = call i64 @word(ptr %lane, i64 24)
  %distance = mul i64 %row, %stride
  %at = getelementptr i8, ptr %address, i64 %distance
  %inside = icmp ult i64 %row, %used
  %result = select i1 %inside, ptr %at, ptr null
  ret ptr %result
}

; Find the row of an element again through its parent's, which is looked up first. Not while somebody changes the lanes.
define internal i1 @find(ptr %self, i64 %depth) noinline {
  %state = call ptr @pointer(ptr %self, i64 16)
  %epoch = call i64 @word(ptr %state, i64 8)
  %parent = call ptr @pointer(ptr %self, i64 96)
  %is.parent = icmp ne ptr %parent, null
  %is.root = icmp eq ptr %parent, @_Py_NoneStruct
  %is.element = xor i1 %is.root, true
  %has.parent = and i1 %is.parent, %is.element
  %free = icmp sge i64 %epoch, 0
  %shallow = icmp sgt i64 %depth, 0
  %may = and i1 %has.parent, %free
  %can = and i1 %may, %shallow
  br i1 %can, label %ask, label %none
ask:
  %parent.state = call ptr @pointer(ptr %parent, i64 16)
  %same = icmp eq ptr %parent.state, %state
  br i1 %same, label %look, label %none
look:
  %found = call i64 @word(ptr %parent, i64 32)
  %current = icmp eq i64 %found, %epoch
  %fixed = icmp eq i64 %found, -9223372036854775808
  %known = or i1 %current, %fixed
  br i1 %known, label %take, label %search
search:
  %less = sub i64 %depth, 1
  %again = call i1 @find(ptr %parent, i64 %less)
  br i1 %again, label %take, label %none
take:
  %row = call ptr @row_found(ptr %parent, ptr %state)
  %has.row = icmp ne ptr %row, null
  br i1 %has.row, label %within, label %none
within:
  %span.at = call i64 @word(ptr %self, i64 64)
  %span = getelementptr i8, ptr %row, i64 %span.at
  %start = load i64, ptr %span
  %count = call i64 @word(ptr %span, i64 8)
  %index = call i64 @word(ptr %self, i64 56)
  %positive = icmp sge i64 %index, 0
  %below = icmp slt i64 %index, %count
  %there = and i1 %positive, %below
  br i1 %there, label %note, label %none
note:
  %number = add i64 %start, %index
  call void @put(ptr %self, i64 24, i64 %number)
  call void @put(ptr %self, i64 32, i64 %epoch)
  ret i1 true
none:
  ret i1 false
}

; Whether a field is there: some bits of its row say so.
define internal i1 @is_present(ptr %place, ptr %row) noinline {
  %mask = call i64 @word(ptr %place, i64 24)
  %always = icmp eq i64 %mask, 0
  br i1 %always, label %yes, label %look
look:
  %offset = call i64 @word(ptr %place, i64 32)
  %wanted = call i64 @word(ptr %place, i64 40)
  %bits = call i64 @word(ptr %row, i64 %offset)
  %masked = and i64 %bits, %mask
  %is = icmp eq i64 %masked, %wanted
  ret i1 %is
yes:
  ret i1 true
}

; The same, where most fields are always there.
define internal i1 @is_there(ptr %place, ptr %row) alwaysinline {
  %mask = call i64 @word(ptr %place, i64 24)
  %always = icmp eq i64 %mask, 0
  br i1 %always, label %yes, label %look, !prof !0
look:
  %is = call i1 @is_present(ptr %place, ptr %row)
  ret i1 %is
yes:
  ret i1 true
}

; Whether so many rows from a start on are in use in a lane, or null where they are not: their address.
define internal ptr @content(ptr %self, ptr %lane, i64 %start, i64 %count) noinline {
  %address = load ptr, ptr %lane
  %used = call i64 @word(ptr %lane, i64 16)
  %stride = call i64 @word(ptr %lane, i64 24)
  %few = icmp ule i64 %count, %used
  %last = sub i64 %used, %count
  %early = icmp ule i64 %start, %last
  %inside = and i1 %few, %early
  %distance = mul i64 %start, %stride
  %at = getelementptr i8, ptr %address, i64 %distance
  %result = select i1 %inside, ptr %at, ptr null
  ret ptr %result
}

; The words of the lane that a message's row lies in.
define internal ptr @own_lane(ptr %self) alwaysinline {
  %state = call ptr @pointer(ptr %self, i64 16)
  %lane.at = call i64 @word(ptr %self, i64 40)
  %lane = getelementptr i8, ptr %state, i64 %lane.at
  ret ptr %lane
}

; The words of the lane that a field's content lies in.
define internal ptr @lane_of(ptr %self, ptr %place) alwaysinline {
  %state = call ptr @pointer(ptr %self, i64 16)
  %offset = call i64 @word(ptr %place, i64 56)
  %lane = getelementptr i8, ptr %state, i64 %offset
  ret ptr %lane
}

; What the place's Python function reads.
define internal ptr @ask(ptr %self, ptr %place) noinline {
  %arguments = alloca [1 x ptr]
  %made = icmp ne ptr %place, null
  br i1 %made, label %call, label %unmade
call:
  %getter = call ptr @pointer(ptr %place, i64 8)
  store ptr %self, ptr %arguments
  %value = call ptr @PyObject_Vectorcall(ptr %getter, ptr %arguments, i64 1, ptr null)
  ret ptr %value
unmade:
  call void @refuse()
  ret ptr null
}

; Let the place's Python function write. To delete an attribute is none of its tasks.
define internal i32 @tell(ptr %self, ptr %place, ptr %value) noinline {
  %arguments = alloca [2 x ptr]
  %made = icmp ne ptr %place, null
  %given = icmp ne ptr %value, null
  %can = and i1 %made, %given
  br i1 %can, label %call, label %unmade
call:
  %setter = call ptr @pointer(ptr %place, i64 16)
  store ptr %self, ptr %arguments
  %second = getelementptr ptr, ptr %arguments, i64 1
  store ptr %value, ptr %second
  %answer = call ptr @PyObject_Vectorcall(ptr %setter, ptr %arguments, i64 2, ptr null)
  %good = icmp ne ptr %answer, null
  br i1 %good, label %done, label %failed
done:
  call void @Py_DecRef(ptr %answer)
  ret i32 0
unmade:
  call void @refuse()
  br label %failed
failed:
  ret i32 -1
}

define internal void @refuse() {
  %error = load ptr, ptr @PyExc_AttributeError
  call void @PyErr_SetString(ptr %error, ptr @never.made)
  ret void
}

; Make a message, all around it and a field present, before the field is written: count the change, and set the bits that say so. False, and
; nothing is done, where more must be done than that, or somebody uses the lanes.
define internal i1 @begin_writing(ptr %self, ptr %place, ptr %row) noinline {
  %state = call ptr @pointer(ptr %self, i64 16)
  %epoch = call i64 @word(ptr %state, i64 8)
  %marks = call ptr @pointer(ptr %place, i64 48)
  %is.easy = icmp ne ptr %marks, null
  %free = icmp sge i64 %epoch, 0
  %can = and i1 %is.easy, %free
  br i1 %can, label %mark, label %no, !prof !0
mark:
  %count = load i64, ptr %marks
  %any = icmp ne i64 %count, 0
  br i1 %any, label %each, label %yes
each:
  %number = phi i64 [ 0, %mark ], [ %next, %each ]
  %base = mul i64 %number, 16
  %offset.at = add i64 %base, 8
  %mask.at = add i64 %base, 16
  %offset = call i64 @word(ptr %marks, i64 %offset.at)
  %mask = call i64 @word(ptr %marks, i64 %mask.at)
  %bits = call i64 @word(ptr %row, i64 %offset)
  %set = or i64 %bits, %mask
  call void @put(ptr %row, i64 %offset, i64 %set)
  %next = add i64 %number, 1
  %more = icmp slt i64 %next, %count
  br i1 %more, label %each, label %yes
yes:
  %found = call i64 @word(ptr %self, i64 32)
  %after = add i64 %epoch, 1
  %current = icmp eq i64 %found, %epoch
  %kept = select i1 %current, i64 %after, i64 %found
  call void @put(ptr %self, i64 32, i64 %kept)
  call void @put(ptr %state, i64 8, i64 %after)
  ret i1 true
no:
  ret i1 false
}

!0 = !{!"branch_weights", i32 1048576, i32 1}

; A field that only Python reads and writes.
define ptr @get_python(ptr %self, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %asked = call ptr @ask(ptr %self, ptr %place)
  ret ptr %asked
}

define i32 @set_python(ptr %self, ptr %value, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %told = call i32 @tell(ptr %self, ptr %place, ptr %value)
  ret i32 %told
}
