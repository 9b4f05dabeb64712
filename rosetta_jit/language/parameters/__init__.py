"""Parameters of mappings: values that are given when a program is made."""
