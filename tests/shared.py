"""What the processes of a run share: workers of xdist, and those that a test starts to run tests in another way."""

FOLDER = "ROSETTA_JIT_TESTS_DIR"
"""The variable by which a run of pytest that a test starts finds the folder of the run around it."""

HEADERS = "headers"
"""The folder in it for headers of C++ that a compiler has read."""

LISP = "lisp"
"""The folder in it for what SBCL has compiled."""
