"""The objects that generated C++ fills and reads: which API their classes have, where their values are, and how rows become them."""
