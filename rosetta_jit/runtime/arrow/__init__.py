"""Batches and Arrow: `tables` of `arrays` of what lies in lanes (`texts`, `times`), and the way `back` with its `leaves`.

Whoever imports this asks for pyarrow, which is an extra.
"""

from importlib.util import find_spec

from rosetta_jit.errors import MissingPackage

if find_spec("pyarrow") is None:
    raise MissingPackage("tables take pyarrow: pip install 'rosetta-jit[arrow]'")
