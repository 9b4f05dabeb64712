"""What runs: holders, programs, the entry from CPython, the cache of compiled kernels."""
