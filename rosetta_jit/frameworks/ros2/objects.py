"""Objects of the classes that rosidl_generator_py writes, and of those of rosbags and of Cyclone DDS."""

from __future__ import annotations

import sys

from rosetta_jit.frameworks.ros2.empty import DUMMY
from rosetta_jit.model.types import name_parts
from rosetta_jit.runtime.holder.objects.foreign import Foreign
from rosetta_jit.runtime.holder.record import Record


def attribute_names(record: Record, field: str) -> tuple[str, ...]:  # noqa: ARG001  of any record
    """The attribute is called as the field is; the field that stands for none need not be there."""
    return () if field == DUMMY else (field,)


def class_of(owner: type, struct: str) -> type | None:  # noqa: ARG001  packages have one class for a message
    """The class that rclpy has for a message: in the package that has its name, if somebody has imported that."""
    package, _, name = "/".join(name_parts(struct)).rpartition("/")
    return getattr(sys.modules.get(f"{package}.msg"), name, None)


OBJECTS = Foreign(names=attribute_names, class_of=class_of, besides=frozenset([DUMMY]))
"""Objects of rclpy's classes, and of those of rosbags and of Cyclone DDS."""
