"""What mappings import."""
