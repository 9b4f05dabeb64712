"""What decoders set in objects without rows, and the decoders that stand in the header."""
