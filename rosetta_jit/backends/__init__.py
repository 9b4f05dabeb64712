"""From a kernel to code."""
