; Python's integers, given out again as floats are (`boxes.ll`): those of one or two digits of 30 bits that CPython keeps no object for. An integer of
; CPython 3.11 has 16 how many digits there are, negative if it is, and from 24 on the digits, the lowest first (Include/cpython/longintrepr.h).
@integers = internal global [8 x ptr] zeroinitializer
@integers.last = internal global i64 0

define internal ptr @box_signed(i64 %value) alwaysinline {
  %above = icmp sgt i64 %value, 256
  %below = icmp slt i64 %value, -5
  %own = or i1 %above, %below
  ; between -(2 ** 60) and 2 ** 60
  %shifted = add i64 %value, 1152921504606846975
  %few = icmp ult i64 %shifted, 2305843009213693951
  %can = and i1 %own, %few
  br i1 %can, label %choose, label %plain
choose:
  %last = load i64, ptr @integers.last
  %next = add i64 %last, 1
  %index = and i64 %next, 7
  store i64 %index, ptr @integers.last
  %place = getelementptr ptr, ptr @integers, i64 %index
  %before = load ptr, ptr %place
  %has = icmp ne ptr %before, null
  br i1 %has, label %look, label %new, !prof !0
look:
  %spare = call i1 @is_spare(ptr %before)
  br i1 %spare, label %again, label %new
again:
  call void @keep(ptr %before)
  br label %write
new:
  %made = call ptr @new_integer(ptr %place)
  %is.made = icmp ne ptr %made, null
  br i1 %is.made, label %write, label %none
write:
  %object = phi ptr [ %before, %again ], [ %made, %new ]
  %negative = icmp slt i64 %value, 0
  %opposite = sub i64 0, %value
  %size = select i1 %negative, i64 %opposite, i64 %value
  %high = lshr i64 %size, 30
  %two = icmp ne i64 %high, 0
  %count = select i1 %two, i64 2, i64 1
  %minus = sub i64 0, %count
  %signed = select i1 %negative, i64 %minus, i64 %count
  %low = and i64 %size, 1073741823
  %upper = shl i64 %high, 32
  %digits = or i64 %upper, %low
  call void @put(ptr %object, i64 16, i64 %signed)
  call void @put(ptr %object, i64 24, i64 %digits)
  ret ptr %object
plain:
  %any = call ptr @PyLong_FromLongLong(i64 %value)
  ret ptr %any
none:
  ret ptr null
}

; A new integer, with room for two digits, which takes the place of one that somebody has kept; null of an error.
define internal ptr @new_integer(ptr %place) noinline {
  %object = call ptr @PyLong_FromLongLong(i64 1099511627776)
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

define internal ptr @box_unsigned(i64 %value) alwaysinline {
  %positive = icmp sge i64 %value, 0
  br i1 %positive, label %signed, label %large
signed:
  %object = call ptr @box_signed(i64 %value)
  ret ptr %object
large:
  %any = call ptr @PyLong_FromUnsignedLongLong(i64 %value)
  ret ptr %any
}

; The value of an integer that has one digit, or is zero, and whether it is such a one.
define internal { i64, i1 } @one_digit(ptr %object) alwaysinline {
  %size = call i64 @word(ptr %object, i64 16)
  %shifted = add i64 %size, 1
  %is = icmp ule i64 %shifted, 2
  %at = getelementptr i8, ptr %object, i64 24
  %digit = load i32, ptr %at
  %positive = zext i32 %digit to i64
  %value = mul i64 %positive, %size
  %one = insertvalue { i64, i1 } undef, i64 %value, 0
  %result = insertvalue { i64, i1 } %one, i1 %is, 1
  ret { i64, i1 } %result
}
