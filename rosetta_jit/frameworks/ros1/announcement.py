"""What a node of ROS 1 tells the master and its subscribers of a type that it publishes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros1.manners import full_text

if TYPE_CHECKING:
    from rosetta_jit.model.types import Schema, Struct


def announcement(struct: Struct, schema: Schema) -> dict[str, str]:
    """Its name, md5 sum and text, which `rosbag record` keeps."""
    return {"type": struct.name, "md5": str(struct.option("md5sum")), "definition": full_text(struct, schema)}
