; The same as fold.ll with registers of 64 bytes, for CPUs that have AVX-512 and VPCLMULQDQ: 256 bytes at a time are folded into 256, those into 64, and
; those into 16. It takes half the time.

declare void @llvm.prefetch.p0(ptr, i32, i32, i32)
declare <8 x i64> @llvm.x86.pclmulqdq.512(<8 x i64>, <8 x i64>, i8 immarg)
declare <2 x i64> @llvm.x86.pclmulqdq(<2 x i64>, <2 x i64>, i8 immarg)

define private <8 x i64> @folded(<8 x i64> %sum, <8 x i64> %by, <8 x i64> %next) alwaysinline {
  %low = call <8 x i64> @llvm.x86.pclmulqdq.512(<8 x i64> %sum, <8 x i64> %by, i8 0)
  %high = call <8 x i64> @llvm.x86.pclmulqdq.512(<8 x i64> %sum, <8 x i64> %by, i8 17)
  %both = xor <8 x i64> %low, %high
  %new = xor <8 x i64> %both, %next
  ret <8 x i64> %new
}

define private <2 x i64> @folded.16(<2 x i64> %sum, <2 x i64> %by, <2 x i64> %next) alwaysinline {
  %low = call <2 x i64> @llvm.x86.pclmulqdq(<2 x i64> %sum, <2 x i64> %by, i8 0)
  %high = call <2 x i64> @llvm.x86.pclmulqdq(<2 x i64> %sum, <2 x i64> %by, i8 17)
  %both = xor <2 x i64> %low, %high
  %new = xor <2 x i64> %both, %next
  ret <2 x i64> %new
}

define private <8 x i64> @four.times(<2 x i64> %pair) alwaysinline {
  %all = shufflevector <2 x i64> %pair, <2 x i64> poison, <8 x i32> <i32 0, i32 1, i32 0, i32 1, i32 0, i32 1, i32 0, i32 1>
  ret <8 x i64> %all
}

; `blocks` blocks of 256 bytes, one at least, to 16 bytes at `to`. The constants are four pairs: what the first bytes are combined with, and the factors that
; move a sum by 64, by 16 and by 256 bytes.
define void @fold(ptr %data, i64 %blocks, ptr %constants, ptr %to) {
start:
  %begin = load <2 x i64>, ptr %constants, align 1
  %at.64 = getelementptr i8, ptr %constants, i64 16
  %pair.64 = load <2 x i64>, ptr %at.64, align 1
  %at.16 = getelementptr i8, ptr %constants, i64 32
  %by.16 = load <2 x i64>, ptr %at.16, align 1
  %at.256 = getelementptr i8, ptr %constants, i64 48
  %pair.256 = load <2 x i64>, ptr %at.256, align 1
  %by.64 = call <8 x i64> @four.times(<2 x i64> %pair.64)
  %by.256 = call <8 x i64> @four.times(<2 x i64> %pair.256)
  %begin.wide = shufflevector <2 x i64> %begin, <2 x i64> zeroinitializer, <8 x i32> <i32 0, i32 1, i32 2, i32 3, i32 2, i32 3, i32 2, i32 3>
  %at1 = getelementptr i8, ptr %data, i64 64
  %at2 = getelementptr i8, ptr %data, i64 128
  %at3 = getelementptr i8, ptr %data, i64 192
  %first = load <8 x i64>, ptr %data, align 1
  %a0 = xor <8 x i64> %first, %begin.wide
  %b0 = load <8 x i64>, ptr %at1, align 1
  %c0 = load <8 x i64>, ptr %at2, align 1
  %d0 = load <8 x i64>, ptr %at3, align 1
  br label %test
test:
  %i = phi i64 [ 1, %start ], [ %i.next, %body ]
  %a = phi <8 x i64> [ %a0, %start ], [ %a.next, %body ]
  %b = phi <8 x i64> [ %b0, %start ], [ %b.next, %body ]
  %c = phi <8 x i64> [ %c0, %start ], [ %c.next, %body ]
  %d = phi <8 x i64> [ %d0, %start ], [ %d.next, %body ]
  %more = icmp slt i64 %i, %blocks
  br i1 %more, label %body, label %end
body:
  %offset = shl i64 %i, 8
  %at.a = getelementptr i8, ptr %data, i64 %offset
  %at.b = getelementptr i8, ptr %at.a, i64 64
  %at.c = getelementptr i8, ptr %at.a, i64 128
  %at.d = getelementptr i8, ptr %at.a, i64 192
  %soon.a = getelementptr i8, ptr %at.a, i64 2048
  %soon.b = getelementptr i8, ptr %at.b, i64 2048
  %soon.c = getelementptr i8, ptr %at.c, i64 2048
  %soon.d = getelementptr i8, ptr %at.d, i64 2048
  call void @llvm.prefetch.p0(ptr %soon.a, i32 0, i32 3, i32 1)
  call void @llvm.prefetch.p0(ptr %soon.b, i32 0, i32 3, i32 1)
  call void @llvm.prefetch.p0(ptr %soon.c, i32 0, i32 3, i32 1)
  call void @llvm.prefetch.p0(ptr %soon.d, i32 0, i32 3, i32 1)
  %next.a = load <8 x i64>, ptr %at.a, align 1
  %next.b = load <8 x i64>, ptr %at.b, align 1
  %next.c = load <8 x i64>, ptr %at.c, align 1
  %next.d = load <8 x i64>, ptr %at.d, align 1
  %a.next = call <8 x i64> @folded(<8 x i64> %a, <8 x i64> %by.256, <8 x i64> %next.a)
  %b.next = call <8 x i64> @folded(<8 x i64> %b, <8 x i64> %by.256, <8 x i64> %next.b)
  %c.next = call <8 x i64> @folded(<8 x i64> %c, <8 x i64> %by.256, <8 x i64> %next.c)
  %d.next = call <8 x i64> @folded(<8 x i64> %d, <8 x i64> %by.256, <8 x i64> %next.d)
  %i.next = add i64 %i, 1
  br label %test
end:
  %ab = call <8 x i64> @folded(<8 x i64> %a, <8 x i64> %by.64, <8 x i64> %b)
  %abc = call <8 x i64> @folded(<8 x i64> %ab, <8 x i64> %by.64, <8 x i64> %c)
  %abcd = call <8 x i64> @folded(<8 x i64> %abc, <8 x i64> %by.64, <8 x i64> %d)
  %p0 = shufflevector <8 x i64> %abcd, <8 x i64> poison, <2 x i32> <i32 0, i32 1>
  %p1 = shufflevector <8 x i64> %abcd, <8 x i64> poison, <2 x i32> <i32 2, i32 3>
  %p2 = shufflevector <8 x i64> %abcd, <8 x i64> poison, <2 x i32> <i32 4, i32 5>
  %p3 = shufflevector <8 x i64> %abcd, <8 x i64> poison, <2 x i32> <i32 6, i32 7>
  %p01 = call <2 x i64> @folded.16(<2 x i64> %p0, <2 x i64> %by.16, <2 x i64> %p1)
  %p012 = call <2 x i64> @folded.16(<2 x i64> %p01, <2 x i64> %by.16, <2 x i64> %p2)
  %p0123 = call <2 x i64> @folded.16(<2 x i64> %p012, <2 x i64> %by.16, <2 x i64> %p3)
  store <2 x i64> %p0123, ptr %to, align 1
  ret void
}
