; Whether the program's own holder belongs to the calling thread.
define internal i1 @is_mine(ptr %context) alwaysinline {
  %owner.at = getelementptr i64, ptr %context, i64 6
  %owner = load i64, ptr %owner.at
  %caller = call i64 @thread()
  %mine = icmp eq i64 %owner, %caller
  ret i1 %mine
}
