; What needs to know what stands behind a holder class (PyTypeObject with what belongs to it, $HEAP_TYPE_BYTES bytes): the calls that make holders, and
; attributes by their names.
;
; First stands the recipe of the class (`making.ll`), null where it must be called as any other; $NAMES_AT its names, null where CPython must look
; up all attributes: 0 mask, and from 8 on, at the first free place from that which the name's address selects, four words an attribute: the name, what
; reads it, what writes it, and what these are given. Of a maker (`attributes.makers`): 16 a list of the plan that its family's holders have, 24 the holder class, 40 the recipe,
; 48 the plan that stood in the list when it was made, 56 the Python function that makes it, and a holder.

@PyType_Type = external global i8
@PyExc_TypeError = external global ptr
@none.taken = private constant [25 x i8] c"new() takes no arguments\00"
declare ptr @PyTuple_New(i64)
declare ptr @PyDict_New()
declare i32 @PyDict_SetItem(ptr, ptr, ptr)

; cls() -> a new holder
define ptr @call_class(ptr %class, ptr %arguments, i64 %nargsf, ptr %names) {
  %count = and i64 %nargsf, 9223372036854775807
  %none = icmp eq i64 %count, 0
  %unnamed = icmp eq ptr %names, null
  %recipe = call ptr @pointer(ptr %class, i64 $HEAP_TYPE_BYTES)
  %known = icmp ne ptr %recipe, null
  %empty = and i1 %none, %unnamed
  %can = and i1 %empty, %known
  br i1 %can, label %make, label %python, !prof !0
make:
  %holder = call ptr @spawned(ptr %class, ptr %recipe)
  ret ptr %holder
python:
  %made = call ptr @call_as_type(ptr %class, ptr %arguments, i64 %count, ptr %names)
  ret ptr %made
}

; What a class does that is called as any other: PyType_Type.tp_call, with a tuple and a dict.
define internal ptr @call_as_type(ptr %class, ptr %arguments, i64 %count, ptr %names) noinline {
  %tuple = call ptr @PyTuple_New(i64 %count)
  %has.tuple = icmp ne ptr %tuple, null
  br i1 %has.tuple, label %head, label %failed
head:
  %index = phi i64 [ 0, %0 ], [ %next, %each ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %sort
each:
  %next = add i64 %index, 1
  %distance = mul i64 %index, 8
  %argument = call ptr @pointer(ptr %arguments, i64 %distance)
  call void @Py_IncRef(ptr %argument)
  %item = add i64 %distance, 24
  call void @put_pointer(ptr %tuple, i64 %item, ptr %argument)
  br label %head
sort:
  %unnamed = icmp eq ptr %names, null
  br i1 %unnamed, label %call, label %collect
collect:
  %dict = call ptr @PyDict_New()
  %has.dict = icmp ne ptr %dict, null
  br i1 %has.dict, label %name.all, label %drop
name.all:
  %named = call i64 @word(ptr %names, i64 16)
  br label %name.head
name.head:
  %number = phi i64 [ 0, %name.all ], [ %next.number, %name.each ]
  %more.names = icmp slt i64 %number, %named
  br i1 %more.names, label %name.each, label %call
name.each:
  %next.number = add i64 %number, 1
  %name.at = mul i64 %number, 8
  %name.item = add i64 %name.at, 24
  %name = call ptr @pointer(ptr %names, i64 %name.item)
  %position = add i64 %count, %number
  %value.at = mul i64 %position, 8
  %value = call ptr @pointer(ptr %arguments, i64 %value.at)
  %set = call i32 @PyDict_SetItem(ptr %dict, ptr %name, ptr %value)
  %good = icmp eq i32 %set, 0
  br i1 %good, label %name.head, label %drop
call:
  %keywords = phi ptr [ null, %sort ], [ %dict, %name.head ]
  %function = call ptr @pointer(ptr @PyType_Type, i64 128)
  %made = call ptr %function(ptr %class, ptr %tuple, ptr %keywords)
  call void @forget(ptr %keywords)
  call void @Py_DecRef(ptr %tuple)
  ret ptr %made
drop:
  %partial = phi ptr [ null, %collect ], [ %dict, %name.each ]
  call void @forget(ptr %partial)
  call void @Py_DecRef(ptr %tuple)
  br label %failed
failed:
  ret ptr null
}

; decoder.new() -> a new holder
define ptr @call_maker(ptr %maker, ptr %arguments, i64 %nargsf, ptr %names) {
  %one = alloca [1 x ptr]
  %count = and i64 %nargsf, 9223372036854775807
  %none = icmp eq i64 %count, 0
  %unnamed = icmp eq ptr %names, null
  %empty = and i1 %none, %unnamed
  br i1 %empty, label %look, label %refuse, !prof !0
look:
  %recipe = call ptr @pointer(ptr %maker, i64 40)
  %known = icmp ne ptr %recipe, @_Py_NoneStruct
  br i1 %known, label %compare, label %python, !prof !0
compare:
  %list = call ptr @pointer(ptr %maker, i64 16)
  %items = call ptr @pointer(ptr %list, i64 24)
  %plan = load ptr, ptr %items
  %seen = call ptr @pointer(ptr %maker, i64 48)
  %same = icmp eq ptr %plan, %seen
  br i1 %same, label %make, label %python, !prof !0
make:
  %class = call ptr @pointer(ptr %maker, i64 24)
  %holder = call ptr @spawned(ptr %class, ptr %recipe)
  ret ptr %holder
python:
  %function = call ptr @pointer(ptr %maker, i64 56)
  store ptr %maker, ptr %one
  %made = call ptr @PyObject_Vectorcall(ptr %function, ptr %one, i64 1, ptr null)
  ret ptr %made
refuse:
  %error = load ptr, ptr @PyExc_TypeError
  call void @PyErr_SetString(ptr %error, ptr @none.taken)
  ret ptr null
}

; cls.from_dict(dict) -> a new holder with all its values. In the method: 24 the holder class, 40 the address of a table (`taking.ll`), if its steps set
; all that a holder has: then it does not matter how the holder begins.
define ptr @method_build(ptr %method, ptr %arguments, i64 %nargsf, ptr %names) {
  %common = call i1 @is_common(ptr %method, i64 %nargsf, ptr %names, i64 1)
  br i1 %common, label %look, label %python, !prof !0
look:
  %class = call ptr @pointer(ptr %method, i64 24)
  %recipe = call ptr @pointer(ptr %class, i64 $HEAP_TYPE_BYTES)
  %known = icmp ne ptr %recipe, null
  br i1 %known, label %make, label %python, !prof !0
make:
  %holder = call ptr @spawned(ptr %class, ptr %recipe)
  %made = icmp ne ptr %holder, null
  br i1 %made, label %fill, label %failed, !prof !0
fill:
  %dict = load ptr, ptr %arguments
  %number = call ptr @pointer(ptr %method, i64 40)
  %converted = call { i64, i1 } @unbox_signed(ptr %number)
  %address = extractvalue { i64, i1 } %converted, 0
  %table = inttoptr i64 %address to ptr
  %taken = call i1 @taken(ptr %holder, ptr %dict, ptr %table)
  br i1 %taken, label %done, label %leave, !prof !0
done:
  ret ptr %holder
leave:
  call void @Py_DecRef(ptr %holder)
  %own = call i1 @is_of_values()
  br i1 %own, label %python, label %failed
failed:
  ret ptr null
python:
  %answer = call ptr @leave_to_python(ptr %method, ptr %arguments, i64 %nargsf, ptr %names)
  ret ptr %answer
}

; Whether there is no error but one that Python's own way, which is tried next, says better; there is none then.
define internal i1 @is_of_values() {
  %error = call ptr @PyErr_Occurred()
  %is.error = icmp ne ptr %error, null
  br i1 %is.error, label %look, label %yes
look:
  %any = load ptr, ptr @PyExc_Exception
  %matches = call i32 @PyErr_ExceptionMatches(ptr %any)
  %is = icmp ne i32 %matches, 0
  br i1 %is, label %clear, label %no
clear:
  call void @PyErr_Clear()
  br label %yes
yes:
  ret i1 true
no:
  ret i1 false
}
@PyExc_Exception = external global ptr

; The attributes of messages: what the class has for a name, without a look into the dicts of all classes above it. What is none of them, and all
; of classes that somebody has derived or changed, is left to CPython.
declare ptr @PyObject_GenericGetAttr(ptr, ptr)

define ptr @get_attribute(ptr %self, ptr %name) {
  %place = call ptr @named(ptr %self, ptr %name)
  %known = icmp ne ptr %place, null
  br i1 %known, label %read, label %generic, !prof !0
read:
  %getter = call ptr @pointer(ptr %place, i64 8)
  %closure = call ptr @pointer(ptr %place, i64 24)
  %value = tail call ptr %getter(ptr %self, ptr %closure)
  ret ptr %value
generic:
  %found = tail call ptr @PyObject_GenericGetAttr(ptr %self, ptr %name)
  ret ptr %found
}

define i32 @set_attribute(ptr %self, ptr %name, ptr %value) {
  %place = call ptr @named(ptr %self, ptr %name)
  %known = icmp ne ptr %place, null
  br i1 %known, label %write, label %generic, !prof !0
write:
  %setter = call ptr @pointer(ptr %place, i64 16)
  %closure = call ptr @pointer(ptr %place, i64 24)
  %written = tail call i32 %setter(ptr %self, ptr %value, ptr %closure)
  ret i32 %written
generic:
  %set = tail call i32 @set_any(ptr %self, ptr %name, ptr %value)
  ret i32 %set
}

; Where the names of an object's class have one, by its address; null if they do not.
define internal ptr @named(ptr %self, ptr %name) alwaysinline {
  %class = call ptr @pointer(ptr %self, i64 8)
  %names = call ptr @pointer(ptr %class, i64 $NAMES_AT)
  %has.names = icmp ne ptr %names, null
  br i1 %has.names, label %begin, label %no
begin:
  %mask = load i64, ptr %names
  %address = ptrtoint ptr %name to i64
  %start = lshr i64 %address, 4
  br label %head
head:
  %number = phi i64 [ %start, %begin ], [ %next, %again ]
  %next = add i64 %number, 1
  %index = and i64 %number, %mask
  %distance = shl i64 %index, 5
  %from = add i64 %distance, 8
  %place = getelementptr i8, ptr %names, i64 %from
  %its = load ptr, ptr %place
  %is.it = icmp eq ptr %its, %name
  br i1 %is.it, label %found, label %look, !prof !0
look:
  %free = icmp eq ptr %its, null
  br i1 %free, label %no, label %again
again:
  br label %head
found:
  ret ptr %place
no:
  ret ptr null
}
