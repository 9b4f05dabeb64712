"""Text of mappings and side files of units → the model."""
