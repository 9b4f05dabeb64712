; Memory for large messages is what the system gives.
define internal void @prefer_large_pages(ptr %begin, i64 %size) alwaysinline {
  ret void
}
