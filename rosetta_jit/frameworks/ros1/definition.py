"""The definition of a message of ROS 1 as bags carry it."""

from __future__ import annotations

from rosetta_jit.frameworks.definitions import Definition
from rosetta_jit.frameworks.ros1.manners import full_text
from rosetta_jit.model.types import Schema, Struct


def definition(struct: Struct, schema: Schema) -> Definition:
    """The text of a type, followed by the texts of the messages in it."""
    return Definition("ros1msg", full_text(struct, schema).encode())
