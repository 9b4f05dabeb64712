"""Kernels as functions of C: statements, expressions, calls and the loops of C++ beside them."""
