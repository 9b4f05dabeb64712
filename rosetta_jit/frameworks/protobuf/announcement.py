"""What an event of RSB says of the message that it carries."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rosetta_jit.model.types import Schema, Struct


def announcement(struct: Struct, schema: Schema) -> dict[str, str]:
    """The wire schema: the qualified name, with a dot in front, as descriptors have it."""
    del schema
    return {"type": f".{struct.name}"}
