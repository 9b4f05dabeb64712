"""What exists to start quickly, and for no other reason."""
