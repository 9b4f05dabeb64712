"""The rules of a mapping as statements of the kernel."""
