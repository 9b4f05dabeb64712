"""What a node of ROS 2 tells others of a type that it publishes."""

from __future__ import annotations

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.ros2.type_hash import rihs01
from rosetta_jit.model.types import Schema, Struct


def announcement(struct: Struct, schema: Schema) -> dict[str, str]:
    """The name of a type, and its hash; types that ROS 2 cannot describe have none."""
    identity = {"type": struct.name.replace("::", "/")}
    try:
        return {**identity, "hash": rihs01(struct, schema)}
    except SchemaError:
        return identity
