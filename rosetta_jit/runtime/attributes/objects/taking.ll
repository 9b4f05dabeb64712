; Objects of other classes, and dicts, taken into messages: by a table of steps, one a field (`holder.objects.steps`).
;
; A table has 0 the number of steps, 8 the class of the objects, 16 its version, 0 of a dict, 24 where their attributes are: 0 in slots or wherever
; the class says, 1 the object is the dict that has them, 2 the object has such a dict; 32 how many that dict must have. Steps of 80 bytes follow: 0 what is set
; (0 a field by a setter, 8 a field that may be absent, 1 the message that the target keeps), 8 the attribute's name, 16 the slot's offset in the
; object or -1, 24 the setter or the table of the message within, 32 the setter's field or where the target keeps the message, 40 the Python
; function that converts a value of a class that is none of 48, 56 and 64, or 0.
;
; CPython gives a class another version when it changes (PyTypeObject: 384), as it then must look up attributes anew; so must we.

declare ptr @PyObject_GetAttr(ptr, ptr)
declare ptr @PyObject_GenericGetDict(ptr, ptr)

; take(table, message, object) -> whether the object was taken; else some of it was, or none, and Python must do it. Errors are those of the
; object's own code, or of values that a field cannot have.
define ptr @take(ptr %module, ptr %arguments, i64 %given) {
  %number = load ptr, ptr %arguments
  %target = call ptr @pointer(ptr %arguments, i64 8)
  %source = call ptr @pointer(ptr %arguments, i64 16)
  %converted = call { i64, i1 } @unbox_signed(ptr %number)
  %address = extractvalue { i64, i1 } %converted, 0
  %table = inttoptr i64 %address to ptr
  %taken = call i1 @taken(ptr %target, ptr %source, ptr %table)
  br i1 %taken, label %yes, label %no, !prof !0
yes:
  %true = call ptr @box_bool(i8 1)
  ret ptr %true
no:
  %error = call ptr @PyErr_Occurred()
  %is.error = icmp ne ptr %error, null
  br i1 %is.error, label %failed, label %left
left:
  %false = call ptr @box_bool(i8 0)
  ret ptr %false
failed:
  ret ptr null
}
declare ptr @PyErr_Occurred()

; take_anew(table, message, object, fresh): the same into a message that is emptied first (`restart`), which nobody else has.
define ptr @take_anew(ptr %module, ptr %arguments, i64 %given) {
  %target = call ptr @pointer(ptr %arguments, i64 8)
  %fresh = call ptr @pointer(ptr %arguments, i64 24)
  %state = call i64 @word(ptr %target, i64 16)
  %words = inttoptr i64 %state to ptr
  %epoch = call i64 @word(ptr %words, i64 8)
  %free = icmp sge i64 %epoch, 0
  br i1 %free, label %empty, label %no
empty:
  %after = add i64 %epoch, 1
  call void @put(ptr %words, i64 8, i64 %after)
  call void @restarted(i64 %state, ptr %fresh)
  call void @put(ptr %words, i64 120, i64 0)
  store i64 1, ptr %words
  %taken = call ptr @take(ptr %module, ptr %arguments, i64 %given)
  ret ptr %taken
no:
  %false = call ptr @box_bool(i8 0)
  ret ptr %false
}

define internal i1 @taken(ptr %target, ptr %source, ptr %table) {
  %class = call ptr @pointer(ptr %table, i64 8)
  %is.class = call i1 @is_exactly(ptr %source, ptr %class)
  br i1 %is.class, label %compare, label %no
compare:
  %version = call i64 @word(ptr %table, i64 16)
  %wanted = trunc i64 %version to i32
  %now.at = getelementptr i8, ptr %class, i64 384
  %now = load i32, ptr %now.at
  %same = icmp eq i32 %now, %wanted
  %any = icmp eq i64 %version, 0
  %current = or i1 %same, %any
  br i1 %current, label %open, label %no
open:
  %mode = call i64 @word(ptr %table, i64 24)
  switch i64 %mode, label %slots [ i64 1, label %itself
                                   i64 2, label %own ]
slots:
  %all = call i1 @take_steps(ptr %target, ptr %source, ptr null, ptr %table)
  ret i1 %all
itself:
  %its = call i1 @take_items(ptr %target, ptr %source, ptr %table)
  ret i1 %its
own:
  %dict = call ptr @PyObject_GenericGetDict(ptr %source, ptr null)
  %has = icmp ne ptr %dict, null
  br i1 %has, label %items, label %no
items:
  %done = call i1 @take_items(ptr %target, ptr %dict, ptr %table)
  call void @Py_DecRef(ptr %dict)
  ret i1 %done
no:
  ret i1 false
}

; Of a dict: 16 how many items it has.
define internal i1 @take_items(ptr %target, ptr %dict, ptr %table) alwaysinline {
  %wanted = call i64 @word(ptr %table, i64 32)
  %count = call i64 @word(ptr %dict, i64 16)
  %whole = icmp eq i64 %count, %wanted
  br i1 %whole, label %take, label %no
take:
  %done = call i1 @take_steps(ptr %target, ptr null, ptr %dict, ptr %table)
  ret i1 %done
no:
  ret i1 false
}

; Each step: of an object, or of a dict.
define internal i1 @take_steps(ptr %target, ptr %source, ptr %dict, ptr %table) {
  %count = load i64, ptr %table
  br label %head
head:
  %index = phi i64 [ 0, %0 ], [ %next, %again ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %next = add i64 %index, 1
  %base = mul i64 %index, 80
  %from = add i64 %base, 40
  %step = getelementptr i8, ptr %table, i64 %from
  %value = call ptr @value_of(ptr %source, ptr %dict, ptr %step)
  %has = icmp ne ptr %value, null
  br i1 %has, label %set, label %no
set:
  %good = call i1 @take_step(ptr %target, ptr %value, ptr %step)
  call void @Py_DecRef(ptr %value)
  br i1 %good, label %again, label %no
again:
  br label %head
done:
  ret i1 true
no:
  ret i1 false
}

; The value of an attribute, and a reference to it; null if it is missing.
define internal ptr @value_of(ptr %source, ptr %dict, ptr %step) alwaysinline {
  %name = call ptr @pointer(ptr %step, i64 8)
  %is.dict = icmp ne ptr %dict, null
  br i1 %is.dict, label %item, label %object
item:
  %found = call ptr @PyDict_GetItemWithError(ptr %dict, ptr %name)
  br label %hold
object:
  %slot = call i64 @word(ptr %step, i64 16)
  %is.slot = icmp sge i64 %slot, 0
  br i1 %is.slot, label %direct, label %attribute
direct:
  %there = call ptr @pointer(ptr %source, i64 %slot)
  br label %hold
hold:
  %value = phi ptr [ %found, %item ], [ %there, %direct ]
  %is = icmp ne ptr %value, null
  br i1 %is, label %count, label %none
count:
  call void @Py_IncRef(ptr %value)
  ret ptr %value
attribute:
  %asked = call ptr @PyObject_GetAttr(ptr %source, ptr %name)
  ret ptr %asked
none:
  ret ptr null
}

define internal i1 @take_step(ptr %target, ptr %value, ptr %step) {
  %kind = load i64, ptr %step
  %what = call ptr @pointer(ptr %step, i64 24)
  %where = call i64 @word(ptr %step, i64 32)
  switch i64 %kind, label %field [ i64 1, label %message
                                   i64 8, label %optional ]
message:
  %inner = call ptr @pointer(ptr %target, i64 %where)
  %has = icmp ne ptr %inner, null
  br i1 %has, label %within, label %no
within:
  ; whoever runs while this is taken may let go of the target, which keeps it
  call void @keep(ptr %inner)
  %taken = call i1 @taken(ptr %inner, ptr %value, ptr %what)
  call void @Py_DecRef(ptr %inner)
  ret i1 %taken
optional:
  %is.none = icmp eq ptr %value, @_Py_NoneStruct
  br i1 %is.none, label %yes, label %field
field:
  %closure = inttoptr i64 %where to ptr
  %converter = call ptr @pointer(ptr %step, i64 40)
  %converts = icmp ne ptr %converter, null
  br i1 %converts, label %sort, label %set
sort:
  %type = call ptr @pointer(ptr %value, i64 8)
  %one = call ptr @pointer(ptr %step, i64 48)
  %two = call ptr @pointer(ptr %step, i64 56)
  %three = call ptr @pointer(ptr %step, i64 64)
  %is.one = icmp eq ptr %type, %one
  %is.two = icmp eq ptr %type, %two
  %is.three = icmp eq ptr %type, %three
  %is.any = or i1 %is.one, %is.two
  %as.is = or i1 %is.any, %is.three
  br i1 %as.is, label %set, label %convert
set:
  %answer = call i32 %what(ptr %target, ptr %value, ptr %closure)
  %good = icmp eq i32 %answer, 0
  ret i1 %good
convert:
  %is.set = call i1 @set_converted(ptr %target, ptr %value, ptr %converter, ptr %what, ptr %closure)
  ret i1 %is.set
yes:
  ret i1 true
no:
  ret i1 false
}

define internal i1 @set_converted(ptr %target, ptr %value, ptr %converter, ptr %setter, ptr %closure) noinline {
  %arguments = alloca [1 x ptr]
  store ptr %value, ptr %arguments
  %converted = call ptr @PyObject_Vectorcall(ptr %converter, ptr %arguments, i64 1, ptr null)
  %has = icmp ne ptr %converted, null
  br i1 %has, label %set, label %no
set:
  %answer = call i32 %setter(ptr %target, ptr %converted, ptr %closure)
  call void @Py_DecRef(ptr %converted)
  %good = icmp eq i32 %answer, 0
  ret i1 %good
no:
  ret i1 false
}
