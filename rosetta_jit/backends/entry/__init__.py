"""The entries from CPython around kernels, and the object code of both."""
