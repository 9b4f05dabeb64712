"""How a holder lies in C: lanes, and the structs of their rows."""
