; Where messages first to count - 1 end when they are written one behind the other from offsets[first]: fills offsets[first + 1] to offsets[count].
; Returns like @many.
define i64 @sizes(ptr %offsets, i64 %first, i64 %count, ptr %state) {
  br label %head
head:
  %index = phi i64 [ %first, %0 ], [ %next, %advance ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %result = call i64 @measure(ptr %state, i64 %index)
  %good = icmp sge i64 %result, 0
  br i1 %good, label %place, label %broken, !prof !0
place:
  %begin.at = getelementptr i64, ptr %offsets, i64 %index
  %begin = load i64, ptr %begin.at
  %end = add i64 %begin, %result
  %sound = icmp sge i64 %end, %begin
  br i1 %sound, label %advance, label %broken, !prof !0
advance:
  %next = add nsw i64 %index, 1
  %end.at = getelementptr i64, ptr %offsets, i64 %next
  store i64 %end, ptr %end.at
  br label %head
done:
  ret i64 %index
broken:
  %why = phi i64 [ %result, %each ], [ 0, %place ]
  call void @note(i64 %why, ptr %state)
  ret i64 %index
}
