"""What encoders read of objects without rows, and the encoders that stand in the header."""
