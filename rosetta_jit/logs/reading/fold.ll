; CRC-32 of zlib by carry-less multiplication, for x86-64 with PCLMULQDQ: "Fast CRC Computation for Generic Polynomials Using PCLMULQDQ Instruction",
; Intel 2009. 64 bytes at a time are folded into 64, and those into 16 bytes in the end, which have the checksum of all: `checksum.py` gives them to zlib. The
; constants come as an argument, so that the code has no data beside it.

declare <2 x i64> @llvm.x86.pclmulqdq(<2 x i64>, <2 x i64>, i8 immarg)

define private <2 x i64> @folded(<2 x i64> %sum, <2 x i64> %by, <2 x i64> %next) alwaysinline {
  %low = call <2 x i64> @llvm.x86.pclmulqdq(<2 x i64> %sum, <2 x i64> %by, i8 0)
  %high = call <2 x i64> @llvm.x86.pclmulqdq(<2 x i64> %sum, <2 x i64> %by, i8 17)
  %both = xor <2 x i64> %low, %high
  %new = xor <2 x i64> %both, %next
  ret <2 x i64> %new
}

; `blocks` blocks of 64 bytes, one at least, to 16 bytes at `to`. The constants are three pairs: what the first bytes are combined with, and the factors that
; move a sum by 64 bytes, and by 16.
define void @fold(ptr %data, i64 %blocks, ptr %constants, ptr %to) {
start:
  %begin = load <2 x i64>, ptr %constants, align 1
  %at.64 = getelementptr i8, ptr %constants, i64 16
  %by.64 = load <2 x i64>, ptr %at.64, align 1
  %at.16 = getelementptr i8, ptr %constants, i64 32
  %by.16 = load <2 x i64>, ptr %at.16, align 1
  %at1 = getelementptr i8, ptr %data, i64 16
  %at2 = getelementptr i8, ptr %data, i64 32
  %at3 = getelementptr i8, ptr %data, i64 48
  %first = load <2 x i64>, ptr %data, align 1
  %a0 = xor <2 x i64> %first, %begin
  %b0 = load <2 x i64>, ptr %at1, align 1
  %c0 = load <2 x i64>, ptr %at2, align 1
  %d0 = load <2 x i64>, ptr %at3, align 1
  br label %test
test:
  %i = phi i64 [ 1, %start ], [ %i.next, %body ]
  %a = phi <2 x i64> [ %a0, %start ], [ %a.next, %body ]
  %b = phi <2 x i64> [ %b0, %start ], [ %b.next, %body ]
  %c = phi <2 x i64> [ %c0, %start ], [ %c.next, %body ]
  %d = phi <2 x i64> [ %d0, %start ], [ %d.next, %body ]
  %more = icmp slt i64 %i, %blocks
  br i1 %more, label %body, label %end
body:
  %offset = shl i64 %i, 6
  %at.a = getelementptr i8, ptr %data, i64 %offset
  %at.b = getelementptr i8, ptr %at.a, i64 16
  %at.c = getelementptr i8, ptr %at.a, i64 32
  %at.d = getelementptr i8, ptr %at.a, i64 48
  %next.a = load <2 x i64>, ptr %at.a, align 1
  %next.b = load <2 x i64>, ptr %at.b, align 1
  %next.c = load <2 x i64>, ptr %at.c, align 1
  %next.d = load <2 x i64>, ptr %at.d, align 1
  %a.next = call <2 x i64> @folded(<2 x i64> %a, <2 x i64> %by.64, <2 x i64> %next.a)
  %b.next = call <2 x i64> @folded(<2 x i64> %b, <2 x i64> %by.64, <2 x i64> %next.b)
  %c.next = call <2 x i64> @folded(<2 x i64> %c, <2 x i64> %by.64, <2 x i64> %next.c)
  %d.next = call <2 x i64> @folded(<2 x i64> %d, <2 x i64> %by.64, <2 x i64> %next.d)
  %i.next = add i64 %i, 1
  br label %test
end:
  %ab = call <2 x i64> @folded(<2 x i64> %a, <2 x i64> %by.16, <2 x i64> %b)
  %abc = call <2 x i64> @folded(<2 x i64> %ab, <2 x i64> %by.16, <2 x i64> %c)
  %abcd = call <2 x i64> @folded(<2 x i64> %abc, <2 x i64> %by.16, <2 x i64> %d)
  store <2 x i64> %abcd, ptr %to, align 1
  ret void
}
