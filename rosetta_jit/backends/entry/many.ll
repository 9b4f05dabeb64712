; Many messages in one call, without the interpreter lock: message i lies at begins[i] to ends[i] and is row i of the holder.

; Messages first to count - 1; returns the first that was not done: count, if all were. Then word 9 of the state (`kernel.state.RESULT`) has the
; kernel's result, or 0 where a message ends before it begins or leaves the buffer. Another thread may write to the places meanwhile: each is
; loaded once where it is checked and used.
define i64 @many(ptr noalias %buffer, i64 %size, ptr %begins, ptr %ends, i64 %first, i64 %count, ptr %state) {
  br label %head
head:
  %index = phi i64 [ %first, %0 ], [ %next, %decode ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %done
each:
  %begin.at = getelementptr i64, ptr %begins, i64 %index
  %begin = load volatile i64, ptr %begin.at
  %next = add nsw i64 %index, 1
  %end.at = getelementptr i64, ptr %ends, i64 %index
  %end = load volatile i64, ptr %end.at
  %positive = icmp sge i64 %begin, 0
  %ordered = icmp sle i64 %begin, %end
  %inside = icmp sle i64 %end, %size
  %known = and i1 %positive, %ordered
  %sound = and i1 %known, %inside
  br i1 %sound, label %ready, label %broken, !prof !0
ready:
  %size.or.failure = call i64 @prepare(ptr %state, i64 %index)
  %prepared = icmp sge i64 %size.or.failure, 0
  br i1 %prepared, label %decode, label %broken, !prof !0
decode:
  %result = call i64 @kernel(ptr %buffer, i64 %begin, i64 %end, ptr %state, i64 %index)
  %good = icmp sge i64 %result, 0
  br i1 %good, label %head, label %broken, !prof !0
done:
  ret i64 %index
broken:
  %why = phi i64 [ 0, %each ], [ %size.or.failure, %ready ], [ %result, %decode ]
  call void @note(i64 %why, ptr %state)
  ret i64 %index
}
