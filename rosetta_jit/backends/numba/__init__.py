"""A kernel as a typed numba function, and users' numba functions for kernels."""
