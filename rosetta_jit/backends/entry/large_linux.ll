; Memory for large messages. The system hands it out page by page, when each is first written; of pages of 2 MB, which it has where it is asked
; (MADV_HUGEPAGE, 14), a message of 100 MB takes 50 instead of 25,000. Only what lies in whole pages is asked for, of up to 64 KB each. It is
; advice: where the system does not take it, nothing is lost.
declare i32 @madvise(ptr, i64, i32)

define internal void @prefer_large_pages(ptr %begin, i64 %size) noinline cold optnone {
  %address = ptrtoint ptr %begin to i64
  %behind = add i64 %address, %size
  %rounded = add i64 %address, 65535
  %first = and i64 %rounded, -65536
  %last = and i64 %behind, -65536
  %length = sub i64 %last, %first
  %page = inttoptr i64 %first to ptr
  %ignored = call i32 @madvise(ptr %page, i64 %length, i32 14)
  ret void
}
