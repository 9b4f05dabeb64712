; Many messages in one call, as in `many.ll`, of a program that keeps values from one message to the next. Its usual body is a part of the loop, as
; @first, so that these values stay in the processor's registers. It sees copies of the state's words and of the program's registers, which nothing
; else can reach: LLVM knows what every load of them gives. What fails there is done again by the whole kernel, on the words themselves.
; The words of the state, the registers, and the lines that copy the used length of each lane are put in (`link.py`).
declare i64 @first(ptr, i64, i64, ptr, i64)
declare i64 @kernel(ptr, i64, i64, ptr, i64)

define i64 @many(ptr noalias %buffer, i64 %size, ptr %begins, ptr %ends, i64 %first, i64 %count, ptr %state) {
  %copy = alloca [$words x i64], align 8
  %registers = alloca [$count x i64], align 8
  call void @llvm.memcpy.p0.p0.i64(ptr align 8 %copy, ptr align 8 %state, i64 $state_bytes, i1 false)
  %home.at = getelementptr i64, ptr %state, i64 16
  %home = load ptr, ptr %home.at
  %lent.at = getelementptr i64, ptr %copy, i64 16
  store ptr %registers, ptr %lent.at
  call void @llvm.memcpy.p0.p0.i64(ptr align 8 %registers, ptr align 8 %home, i64 $register_bytes, i1 false)
  br label %head
head:
  %index = phi i64 [ %first, %0 ], [ %next, %decode ], [ %next, %again ]
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
  br i1 %sound, label %decode, label %broken, !prof !0
decode:
  %quick = call i64 @first(ptr %buffer, i64 %begin, i64 %end, ptr %copy, i64 %index)
  %good = icmp sge i64 %quick, 0
  br i1 %good, label %head, label %other, !prof !0
other:
  call void @bring_back(ptr %state, ptr %copy, ptr %home, ptr %registers)
  %result = call i64 @kernel(ptr %buffer, i64 %begin, i64 %end, ptr %state, i64 %index)
  %done.after.all = icmp sge i64 %result, 0
  br i1 %done.after.all, label %again, label %failed
again:
  call void @bring_back(ptr %copy, ptr %state, ptr %registers, ptr %home)
  br label %head
failed:
  call void @note_failure(i64 %result, ptr %state)
  ret i64 %index
broken:
  call void @bring_back(ptr %state, ptr %copy, ptr %home, ptr %registers)
  call void @note_failure(i64 0, ptr %state)
  ret i64 %index
done:
  call void @bring_back(ptr %state, ptr %copy, ptr %home, ptr %registers)
  ret i64 %index
}

; What kernels change and others read: used lengths, and registers.
define internal void @bring_back(ptr %state, ptr %from.state, ptr %registers, ptr %from.registers) alwaysinline {
  call void @llvm.memcpy.p0.p0.i64(ptr align 8 %registers, ptr align 8 %from.registers, i64 $register_bytes, i1 false)
$used
  ret void
}

; Leave the result of a kernel that has failed for the slow path.
define internal void @note_failure(i64 %result, ptr %state) alwaysinline {
  %result.at = getelementptr i64, ptr %state, i64 9
  store i64 %result, ptr %result.at
  ret void
}

declare void @llvm.memcpy.p0.p0.i64(ptr noalias, ptr noalias, i64, i1 immarg)
!0 = !{!"branch_weights", i32 1048576, i32 1}
