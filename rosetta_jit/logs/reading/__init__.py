"""What readers of several formats share: the bytes of a log, its records and chunks, and compiled walks over them."""
