; The rest is compiled when it is first asked for (`rosetta_jit.runtime.rest`), and found in @rest from then on. Until then the slow path does what is
; not usual.
@rest = dso_local global ptr null

define internal ptr @any_call(ptr %self, ptr %args, i64 %nargsf, ptr %names) alwaysinline {
  %rest = load atomic ptr, ptr @rest acquire, align 8
  %is.made = icmp ne ptr %rest, null
  br i1 %is.made, label %go.on, label %slow
go.on:
  %found = musttail call ptr %rest(ptr %self, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %found
slow:
  %context = call ptr @context(ptr %self)
  %answer = tail call ptr @slow(ptr %context, ptr %args, i64 %nargsf, ptr %names)
  ret ptr %answer
}
