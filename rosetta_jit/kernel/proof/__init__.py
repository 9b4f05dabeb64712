"""The proof that a kernel is safe."""
