"""What mappings import, and where it is found."""
