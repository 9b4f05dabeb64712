; New bytes, which are not written yet, or null if there is no memory for them. From 4 MB on it pays to ask for large pages.
define internal ptr @new_bytes(i64 %size) alwaysinline {
  %bytes = call ptr @PyBytes_FromStringAndSize(ptr null, i64 %size)
  %is.small = icmp slt i64 %size, 4194304
  br i1 %is.small, label %done, label %large, !prof !0
large:
  %there = icmp ne ptr %bytes, null
  br i1 %there, label %advise, label %done, !prof !0
advise:
  %data = getelementptr i8, ptr %bytes, i64 32
  call void @prefer_large_pages(ptr %data, i64 %size)
  br label %done
done:
  ret ptr %bytes
}
