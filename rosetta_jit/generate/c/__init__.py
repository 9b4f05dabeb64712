"""C11 without allocation, mutable globals or dependencies."""
