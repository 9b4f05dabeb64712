"""The mapping language: its syntax, names, types, checks and laws. No kernel in sight."""
