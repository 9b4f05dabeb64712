"""What values are measured in."""
