"""Names of fields in our own classes."""

from __future__ import annotations

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.c.words import RESERVED, of_unit
from rosetta_jit.model.types import Struct

OWN_WORDS = frozenset({"unknown_fields", "std", "rosetta_jit"})
NOT_NAMESPACES = RESERVED | {"main", "std", "rosetta_jit"}
"""What no unit may be called: its namespace is called so."""


def member_names(struct: Struct, unit: str, class_: str) -> tuple[str, ...]:
    """Those of a struct's fields, in order: each another, none a word of C++ or the struct's own class."""
    scope = Namespace(RESERVED | OWN_WORDS | {class_} | of_unit(unit, (each.name for each in struct.fields)))
    return tuple(scope.identifier(each.name) for each in struct.fields)
