"""The definition of a type as a log carries it beside the messages: a text, or descriptors, and the name of their language.

Languages have MCAP's names where it has any (https://mcap.dev/spec/registry), else those of the files: ``lcm``, ``bottle-schema``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.model.serial import to_plain
from rosetta_jit.model.types import Declaration, Ref, Schema, Struct
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.source import Source


@dataclass(frozen=True, slots=True)
class Definition:
    """The definition of a type, and of all types that it needs."""

    language: str
    data: bytes


def declared(struct: Struct, schema: Schema) -> dict[str, Declaration]:
    """A struct and all types that it needs, by name; it comes first."""
    names = to_plain(Ref(struct.name), schema)["declared"]
    return {struct.name: struct} | {name: schema.types[name] for name in names}


def sources(struct: Struct, schema: Schema) -> list[Source]:
    """The files that declare a struct and what it needs, each once; its own comes first."""
    spans = [each.span for each in declared(struct, schema).values()]
    return list({each.source.name: each.source for each in spans if each is not None}.values())
