; The holder keeps views into the message: item 0 of its source cell, a list, becomes the object whose memory they see.
define internal void @retain(ptr %context, ptr %source) alwaysinline {
  %kept = call ptr @keep_any(ptr %source)
  %cell.at = getelementptr ptr, ptr %context, i64 3
  %cell = load ptr, ptr %cell.at
  %items.at = getelementptr i8, ptr %cell, i64 24
  %items = load ptr, ptr %items.at
  %last = load ptr, ptr %items
  store ptr %kept, ptr %items
  call void @drop_any(ptr %last)
  ret void
}
