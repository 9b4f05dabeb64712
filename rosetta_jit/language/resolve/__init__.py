"""Names and types: the rules of a mapping as the parser leaves them → typed rules."""
