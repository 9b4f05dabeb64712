"""What is wrong, or suspect, with rules taken together."""
