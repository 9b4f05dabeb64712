; A number or a boolean: $NAME is one of the scalars of `runtime.cells`, $CELL its type in memory, $WIDE the type that Python is given.

define ptr @get_$NAME(ptr %self, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %row = call ptr @row_at_once(ptr %self)
  %has.row = icmp ne ptr %row, null
  br i1 %has.row, label %look, label %python, !prof !0
look:
  %present = call i1 @is_there(ptr %place, ptr %row)
  br i1 %present, label %read, label %python, !prof !0
read:
  %offset = load i64, ptr %place
  %at = getelementptr i8, ptr %row, i64 %offset
  %cell = load $CELL, ptr %at
  %value = $WIDEN
  %object = call ptr @box_$BOX($WIDE %value)
  ret ptr %object
python:
  %asked = call ptr @ask(ptr %self, ptr %place)
  ret ptr %asked
}

define i32 @set_$NAME(ptr %self, ptr %value, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %row = call ptr @row_at_once(ptr %self)
  %has.row = icmp ne ptr %row, null
  %given = icmp ne ptr %value, null
  %can = and i1 %has.row, %given
  br i1 %can, label %convert, label %python, !prof !0
convert:
  %converted = call { $WIDE, i1 } @$UNBOX(ptr %value)
  %wide = extractvalue { $WIDE, i1 } %converted, 0
  %is.one = extractvalue { $WIDE, i1 } %converted, 1
  br i1 %is.one, label %narrow, label %python, !prof !0
narrow:
  %cell = $NARROW
  %back = $BACK
  %fits = $FITS
  br i1 %fits, label %begin, label %python, !prof !0
begin:
  %begun = call i1 @begin_writing(ptr %self, ptr %place, ptr %row)
  br i1 %begun, label %write, label %python, !prof !0
write:
  %offset = load i64, ptr %place
  %at = getelementptr i8, ptr %row, i64 %offset
  store $CELL %cell, ptr %at
  ret i32 0
python:
  %told = call i32 @tell(ptr %self, ptr %place, ptr %value)
  ret i32 %told
}
