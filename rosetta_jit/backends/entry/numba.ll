; numba's calling convention: a status is returned, the result goes through the first argument. The kernel raises nothing, so the status is 0.

declare i32 @typed(ptr, ptr, ptr, i64, i64, ptr, i64)

define i64 @kernel(ptr noalias %buffer, i64 %begin, i64 %end, ptr noalias %state, i64 %row) {
  %result.at = alloca i64
  %exception.at = alloca ptr
  %status = call i32 @typed(ptr %result.at, ptr %exception.at, ptr %buffer, i64 %begin, i64 %end, ptr %state, i64 %row)
  %result = load i64, ptr %result.at
  ret i64 %result
}
