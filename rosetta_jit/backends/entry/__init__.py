"""The entries from CPython around kernels, in LLVM's language, and the object code of both."""
