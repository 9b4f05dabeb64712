; Python's integers, made anew.

define internal ptr @box_signed(i64 %value) alwaysinline {
  %object = call ptr @PyLong_FromLongLong(i64 %value)
  ret ptr %object
}

define internal ptr @box_unsigned(i64 %value) alwaysinline {
  %object = call ptr @PyLong_FromUnsignedLongLong(i64 %value)
  ret ptr %object
}
