"""Generated Common Lisp."""
