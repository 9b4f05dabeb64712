; Where a kernel has failed: messages that hardly ever come, which begin with $size bytes as no others do, are another program's. Its kernel is found
; in @on_demand once it is made (`rosetta_jit.runtime.on_demand`), and goes on. Its sites count from behind the $sites of this program.
@on_demand = dso_local global ptr null

define preserve_mostcc i64 @$name(ptr %buffer, i64 %begin, i64 %end, ptr %state, i64 %row) noinline nounwind {
  %size = sub i64 %end, %begin
  %enough = icmp sge i64 %size, $size
  br i1 %enough, label %look, label %failed
look:
  %at = getelementptr i8, ptr %buffer, i64 %begin
  %opening = load i$bits, ptr %at, align 1
  %is.rare = icmp eq i$bits %opening, $opening
  br i1 %is.rare, label %find, label %failed
find:
  %kernel = load atomic ptr, ptr @on_demand acquire, align 8
  %is.made = icmp ne ptr %kernel, null
  br i1 %is.made, label %go.on, label %failed
go.on:
  %result = call i64 %kernel(ptr %buffer, i64 %begin, i64 %end, ptr %state, i64 %row)
  %is.failure = icmp slt i64 %result, -1
  %behind = sub i64 %result, $sites
  %answer = select i1 %is.failure, i64 %behind, i64 %result
  ret i64 %answer
failed:
  %site.at = getelementptr i64, ptr %state, i64 $site
  %site = load i64, ptr %site.at
  %told = sub i64 -1, %site
  ret i64 %told
}
