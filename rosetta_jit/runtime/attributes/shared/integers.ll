; Python's integers, made anew, and read by CPython alone.

define internal ptr @box_signed(i64 %value) alwaysinline {
  %object = call ptr @PyLong_FromLongLong(i64 %value)
  ret ptr %object
}

define internal ptr @box_unsigned(i64 %value) alwaysinline {
  %object = call ptr @PyLong_FromUnsignedLongLong(i64 %value)
  ret ptr %object
}

define internal { i64, i1 } @one_digit(ptr %object) alwaysinline {
  ret { i64, i1 } zeroinitializer
}
