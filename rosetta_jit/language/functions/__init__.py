"""The functions of the language: their types."""
