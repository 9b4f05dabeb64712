; The kernel's first body is part of the usual call; what it leaves to the next one is told by a result that is no other (`backends.llvm.function`).
declare i64 @kernel.usual(ptr, i64, i64, ptr, i64)

define internal i64 @usual(ptr %data, i64 %size, ptr %state) alwaysinline {
  %result = call i64 @kernel.usual(ptr %data, i64 0, i64 %size, ptr %state, i64 0)
  ret i64 %result
}

define internal ptr @state_behind(ptr %context, ptr %state) alwaysinline {
  ret ptr %state
}
