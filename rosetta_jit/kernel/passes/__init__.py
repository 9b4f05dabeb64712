"""Passes: a kernel → a better one that means the same. `order` runs them."""
