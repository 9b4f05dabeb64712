"""Logs: recordings of any kind, opened by one function, read as messages, columns and tables."""
