"""The definition of a type of LCM as one text: files one behind the other, of which each begins with its package."""

from __future__ import annotations

from rosetta_jit.frameworks.definitions import Definition, sources
from rosetta_jit.model.types import Schema, Struct


def definition(struct: Struct, schema: Schema) -> Definition:
    """The texts of all files that declare it."""
    return Definition("lcm", "\n".join(each.text for each in sources(struct, schema)).encode())
