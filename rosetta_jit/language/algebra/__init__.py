"""Whether expressions of the language are the same: their normal forms."""
