"""The bytes of a message as statements of the kernel: the walk over a codec."""
