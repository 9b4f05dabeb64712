; Before a message: the time and the message's number, which no other gets, go into the state (`kernel.state.NOW`, `NUMBER`). Whoever runs many messages in one call
; does this for all of them (`runtime.program`).

declare i32 @clock_gettime(i32, ptr)

; CLOCK_REALTIME is 0; seconds and nanoseconds are int64 (POSIX, time.h, where time_t has 64 bits).
define internal void @tell(ptr %context, ptr %state) alwaysinline {
  %time = alloca [16 x i8], align 8
  %status = call i32 @clock_gettime(i32 0, ptr %time)
  %seconds = load i64, ptr %time
  %rest.at = getelementptr i8, ptr %time, i64 8
  %rest = load i64, ptr %rest.at
  %whole = mul i64 %seconds, 1000000000
  %now = add i64 %whole, %rest
  %now.at = getelementptr i64, ptr %state, i64 12
  store i64 %now, ptr %now.at
  %made.at = getelementptr i64, ptr %context, i64 5
  %made = load i64, ptr %made.at
  %number.at = getelementptr i64, ptr %state, i64 13
  store i64 %made, ptr %number.at
  %more = add i64 %made, 1
  store i64 %more, ptr %made.at
  ret void
}

; Behind a message that could not be made: the next one gets its number, unless another thread has taken one since.
define internal void @untell(ptr %context, ptr %state) alwaysinline {
  %made.at = getelementptr i64, ptr %context, i64 5
  %made = load i64, ptr %made.at
  %number.at = getelementptr i64, ptr %state, i64 13
  %number = load i64, ptr %number.at
  %more = add i64 %number, 1
  %last = icmp eq i64 %made, %more
  %next = select i1 %last, i64 %number, i64 %made
  store i64 %next, ptr %made.at
  ret void
}
