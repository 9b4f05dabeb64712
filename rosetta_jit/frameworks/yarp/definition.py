"""The definition of a type of YARP as one text: its file, where that needs no other."""

from __future__ import annotations

from rosetta_jit.frameworks.definitions import Definition, sources
from rosetta_jit.model.types import Schema, Struct


def definition(struct: Struct, schema: Schema) -> Definition | None:
    """The text of the file that declares it; None where several do, which cannot be put together."""
    own = sources(struct, schema)
    if len(own) != 1 or not own[0].name.endswith(".bottle-schema"):
        return None
    return Definition("bottle-schema", own[0].text.encode())
