"""Decoders: kernels that find what is in a message, and the objects that are made of it."""
