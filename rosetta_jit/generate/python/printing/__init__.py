"""Kernels as Python: what decoders and encoders have in common."""
