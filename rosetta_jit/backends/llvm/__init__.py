"""A kernel as one LLVM function."""
