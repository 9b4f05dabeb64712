"""Rules about whole arrays: their layouts, and the loops over their elements."""
