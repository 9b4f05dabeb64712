; What a call ends with: the holder, or what the slow path says.
define internal ptr @finish(ptr %context, ptr %state, ptr %args, ptr %message, i64 %result) alwaysinline {
  %good = icmp sge i64 %result, 0
  br i1 %good, label %return, label %failed, !prof !0
return:
  store i64 1, ptr %state
  %source = call ptr @message_behind(ptr %state, ptr %message)
  call void @retain(ptr %context, ptr %source)
  %holder.at = getelementptr ptr, ptr %context, i64 1
  %holder = load ptr, ptr %holder.at
  call void @keep(ptr %holder)
  ret ptr %holder
failed:
  store i64 0, ptr %state
  %arguments = call ptr @arguments_behind(ptr %state, ptr %args)
  call void @untell(ptr %context, ptr %state)
  call void @say_failed(ptr %context)
  call void @note(i64 %result, ptr %state)
  %answer = tail call ptr @slow(ptr %context, ptr %arguments, i64 1, ptr null)
  ret ptr %answer
}
