"""Encoders: objects taken apart, and the parts of a message joined."""
