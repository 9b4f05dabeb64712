"""The kernel IR: its grammar and meaning, its printer, its interpreter, and the proof that a kernel is safe."""
