"""Kernels as Python runs them best: what is found out about them, and what is changed, before a line of Python is printed."""
