; A list of texts. Their rows are made first; each text is then written where the old one of its row lies, or behind the others.
define i32 @set_texts(ptr %self, ptr %value, ptr %field) {
  %place = call ptr @place(ptr %self, ptr %field)
  %given = icmp ne ptr %value, null
  br i1 %given, label %sort, label %python
sort:
  %is.list = call i1 @is_exactly(ptr %value, ptr @PyList_Type)
  br i1 %is.list, label %list, label %python
list:
  %count = call i64 @word(ptr %value, i64 16)
  %items = call ptr @pointer(ptr %value, i64 24)
  %longest = call i64 @word(ptr %place, i64 224)
  %total = call i64 @total_size(ptr %items, i64 %count, i64 %longest)
  %good = icmp sge i64 %total, 0
  br i1 %good, label %make, label %python
make:
  %done = call i1 @write_texts(ptr %self, ptr %place, ptr %value, i64 0, i64 %count, i64 %total)
  br i1 %done, label %end, label %python
end:
  ret i32 0
python:
  %told = call i32 @tell(ptr %self, ptr %place, ptr %value)
  ret i32 %told
}

; How many bytes texts have together; -1 if one is none, or has more bytes than it may.
define internal i64 @total_size(ptr %items, i64 %count, i64 %most) {
  br label %head
head:
  %index = phi i64 [ 0, %0 ], [ %next, %add ]
  %sum = phi i64 [ 0, %0 ], [ %added, %add ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %next = add i64 %index, 1
  %item.at = getelementptr ptr, ptr %items, i64 %index
  %item = load ptr, ptr %item.at
  %content = call { ptr, i64 } @bytes_of(ptr %item, ptr @PyUnicode_Type)
  %data = extractvalue { ptr, i64 } %content, 0
  %size = extractvalue { ptr, i64 } %content, 1
  %is = icmp ne ptr %data, null
  %short = icmp sle i64 %size, %most
  %allowed = and i1 %is, %short
  br i1 %allowed, label %add, label %no
add:
  %added = add i64 %sum, %size
  br label %head
done:
  ret i64 %sum
no:
  ret i64 -1
}

; Write the texts of a list, of which the size is known, into the elements of a field from one on; the field has them and those before it. The list
; is looked at again where other code may have run. False, and the field is as it was, where Python must do it.
define internal i1 @write_texts(ptr %self, ptr %place, ptr %list, i64 %first, i64 %count, i64 %total) {
  %most = call i64 @word(ptr %place, i64 88)
  %least = call i64 @word(ptr %place, i64 80)
  %all = add i64 %first, %count
  %few = icmp sle i64 %all, %most
  %enough = icmp sge i64 %all, %least
  %allowed = and i1 %few, %enough
  br i1 %allowed, label %find, label %python
find:
  %tries = phi i64 [ 0, %0 ], [ %tried, %find.again ]
  %row = call ptr @row(ptr %self)
  %has.row = icmp ne ptr %row, null
  br i1 %has.row, label %look, label %python
look:
  %offset = load i64, ptr %place
  %span = getelementptr i8, ptr %row, i64 %offset
  %state = call ptr @pointer(ptr %self, i64 16)
  %lane = call ptr @lane_of(ptr %self, ptr %place)
  %target.at = call i64 @word(ptr %place, i64 168)
  %texts = getelementptr i8, ptr %state, i64 %target.at
  %capacity = call i64 @word(ptr %texts, i64 8)
  %used = call i64 @word(ptr %texts, i64 16)
  %behind = add i64 %used, %total
  %text.lack = sub i64 %behind, %capacity
  %text.lacks = icmp sgt i64 %text.lack, 0
  %missing = call i64 @lacking(ptr %lane, ptr %span, i64 %all)
  %known = icmp sge i64 %missing, 0
  br i1 %known, label %enough.rows, label %python
enough.rows:
  %row.lacks = icmp sgt i64 %missing, 0
  %lacks = or i1 %row.lacks, %text.lacks
  br i1 %lacks, label %grow, label %begin
grow:
  %tried = add i64 %tries, 1
  %lane.at = call i64 @word(ptr %place, i64 56)
  %which = select i1 %row.lacks, i64 %lane.at, i64 %target.at
  %rows = select i1 %row.lacks, i64 %missing, i64 %text.lack
  %early = icmp slt i64 %tries, 3
  br i1 %early, label %ask, label %python
ask:
  %is.made = call i1 @make_room(ptr %self, ptr %place, i64 %which, i64 %rows)
  br i1 %is.made, label %made, label %python
made:
  %now.count = call i64 @word(ptr %list, i64 16)
  %now.items = call ptr @pointer(ptr %list, i64 24)
  %same.count = icmp eq i64 %now.count, %count
  br i1 %same.count, label %sum, label %python
sum:
  %longest = call i64 @word(ptr %place, i64 224)
  %now.total = call i64 @total_size(ptr %now.items, i64 %count, i64 %longest)
  %same.total = icmp eq i64 %now.total, %total
  br i1 %same.total, label %find.again, label %python
find.again:
  br label %find
begin:
  %begun = call i1 @begin_writing(ptr %self, ptr %place, ptr %row)
  br i1 %begun, label %resize, label %python
resize:
  %within = call i64 @word(ptr %place, i64 160)
  %old = call i64 @word(ptr %span, i64 8)
  %old.start = load i64, ptr %span
  %stride = call i64 @word(ptr %lane, i64 24)
  %old.rows = call ptr @element_row(ptr %lane, i64 %old.start)
  %around = call ptr @own_lane(ptr %self)
  %target = call ptr @resized(ptr %state, ptr %around, ptr %lane, ptr %span, i64 %all)
  ; rows that stayed keep their old texts' places; the others have none
  %fewer = icmp slt i64 %all, %old
  %common = select i1 %fewer, i64 %all, i64 %old
  call void @waste_texts(ptr %state, ptr %texts, ptr %old.rows, i64 %stride, i64 %within, i64 %all, i64 %old)
  %kept.bytes = mul i64 %common, %stride
  %moved = icmp ne ptr %target, %old.rows
  %any = icmp sgt i64 %common, 0
  %copy = and i1 %moved, %any
  br i1 %copy, label %carry, label %zero
carry:
  call void @llvm.memmove.p0.p0.i64(ptr %target, ptr %old.rows, i64 %kept.bytes, i1 false)
  br label %zero
zero:
  %all.bytes = mul i64 %all, %stride
  %new.bytes = sub i64 %all.bytes, %kept.bytes
  %new.at = getelementptr i8, ptr %target, i64 %kept.bytes
  call void @llvm.memset.p0.i64(ptr %new.at, i8 0, i64 %new.bytes, i1 false)
  %items = call ptr @pointer(ptr %list, i64 24)
  br label %head
head:
  %index = phi i64 [ 0, %zero ], [ %next, %put ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %next = add i64 %index, 1
  %item.at = getelementptr ptr, ptr %items, i64 %index
  %item = load ptr, ptr %item.at
  %content = call { ptr, i64 } @bytes_of(ptr %item, ptr @PyUnicode_Type)
  %data = extractvalue { ptr, i64 } %content, 0
  %size = extractvalue { ptr, i64 } %content, 1
  br label %write
write:
  %element = add i64 %first, %index
  %distance = mul i64 %element, %stride
  %shift = add i64 %distance, %within
  %text.span = getelementptr i8, ptr %target, i64 %shift
  %text.start = load i64, ptr %text.span
  %text.count = call i64 @word(ptr %text.span, i64 8)
  %text.used = call i64 @word(ptr %texts, i64 16)
  %sound = call i1 @is_sound(i64 %text.start, i64 %text.count, i64 %text.used)
  br i1 %sound, label %put, label %mend
mend:
  store i64 0, ptr %text.span
  call void @put(ptr %text.span, i64 8, i64 0)
  br label %put
put:
  %text.at = call ptr @resized(ptr %state, ptr %lane, ptr %texts, ptr %text.span, i64 %size)
  call void @llvm.memmove.p0.p0.i64(ptr %text.at, ptr %data, i64 %size, i1 false)
  br label %head
done:
  ret i1 true
python:
  ret i1 false
}

; Note that the texts of rows from one on to another are not referred to any more.
define internal void @waste_texts(ptr %state, ptr %texts, ptr %rows, i64 %stride, i64 %within, i64 %from, i64 %to) {
  br label %head
head:
  %row = phi i64 [ %from, %0 ], [ %next, %each ]
  %sum = phi i64 [ 0, %0 ], [ %added, %each ]
  %more = icmp slt i64 %row, %to
  br i1 %more, label %each, label %done
each:
  %next = add i64 %row, 1
  %distance = mul i64 %row, %stride
  %shift = add i64 %distance, %within
  %span = getelementptr i8, ptr %rows, i64 %shift
  %count = call i64 @word(ptr %span, i64 8)
  %added = add i64 %sum, %count
  br label %head
done:
  %any = icmp sgt i64 %sum, 0
  br i1 %any, label %note, label %end
note:
  call void @waste(ptr %state, ptr %texts, i64 %sum)
  br label %end
end:
  ret void
}

; extend_texts(sequence, list) -> bool: whether the texts of a list were appended to a sequence; else Python must do it. METH_FASTCALL.
define ptr @extend_texts(ptr %module, ptr %arguments, i64 %given) {
  %sequence = load ptr, ptr %arguments
  %list = call ptr @pointer(ptr %arguments, i64 8)
  %found = call { i64, i64 } @elements(ptr %sequence)
  %first = extractvalue { i64, i64 } %found, 1
  %known = icmp sge i64 %first, 0
  %is.list = call i1 @is_exactly(ptr %list, ptr @PyList_Type)
  %can = and i1 %known, %is.list
  br i1 %can, label %look, label %python
look:
  %message = call ptr @pointer(ptr %sequence, i64 32)
  %place = call ptr @pointer(ptr %sequence, i64 16)
  %kind = call i64 @word(ptr %place, i64 128)
  %is.utf8 = icmp eq i64 %kind, 2
  br i1 %is.utf8, label %measure, label %python
measure:
  %count = call i64 @word(ptr %list, i64 16)
  %items = call ptr @pointer(ptr %list, i64 24)
  %longest = call i64 @word(ptr %place, i64 224)
  %total = call i64 @total_size(ptr %items, i64 %count, i64 %longest)
  %good = icmp sge i64 %total, 0
  br i1 %good, label %write, label %python
write:
  %done = call i1 @write_texts(ptr %message, ptr %place, ptr %list, i64 %first, i64 %count, i64 %total)
  %answer = zext i1 %done to i8
  %said = call ptr @box_bool(i8 %answer)
  ret ptr %said
python:
  %no = call ptr @box_bool(i8 0)
  ret ptr %no
}
