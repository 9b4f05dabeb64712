"""C++17: classes, of our own or of a framework, filled and read by the same kernels as in C."""
