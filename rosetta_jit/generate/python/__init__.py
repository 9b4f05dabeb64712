"""Python: one module without dependencies, of dataclasses and the functions that read and write them."""
