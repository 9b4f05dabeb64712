; The rest is a part of the program.
declare ptr @any_call(ptr, ptr, i64, ptr)
