"""What a node of ROS 1 tells the master and its peers of a type that it publishes, or of a service that it serves or calls."""

from __future__ import annotations

from rosetta_jit.frameworks.ros1.manners import full_text
from rosetta_jit.model.types import Schema, Struct


def announcement(struct: Struct, schema: Schema) -> dict[str, str]:
    """Of a message its name, md5 sum and text, which `rosbag record` keeps; of a request or a response those of the service."""
    service = struct.option("service_md5sum")
    if service is not None:
        end = "Request" if struct.name.endswith("Request") else "Response"
        return {"type": struct.name.removesuffix(end), "md5": str(service)}
    return {"type": struct.name, "md5": str(struct.option("md5sum")), "definition": full_text(struct, schema)}
