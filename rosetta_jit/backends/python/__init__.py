"""A kernel as Python source."""
