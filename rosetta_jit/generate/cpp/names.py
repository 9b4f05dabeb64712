"""Names of fields in our own classes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.backends.base import Namespace
from rosetta_jit.generate.c.words import RESERVED

if TYPE_CHECKING:
    from rosetta_jit.model.types import Struct

OWN_WORDS = frozenset({"unknown_fields", "std", "rosetta_jit"})


def member_names(struct: Struct) -> tuple[str, ...]:
    """Those of a struct's fields, in order: each another, none a word of C++."""
    scope = Namespace(RESERVED | OWN_WORDS)
    return tuple(scope.identifier(each.name) for each in struct.fields)
