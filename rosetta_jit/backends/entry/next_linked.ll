; The next call is a part of the program.
declare ptr @call_of_next(ptr, ptr)
