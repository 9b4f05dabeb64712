; The calling thread, as Python's `threading.get_ident` says it.
declare i64 @PyThread_get_thread_ident()

define internal i64 @thread() alwaysinline {
  %thread = call i64 @PyThread_get_thread_ident()
  ret i64 %thread
}
