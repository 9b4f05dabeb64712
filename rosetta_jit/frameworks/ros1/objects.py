"""Objects of ROS 1's messages that other packages make: genpy's classes, and those of rosbags.

These have ROS 2's names for moments, and a field in messages that have none.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from rosetta_jit.model.types import name_parts
from rosetta_jit.runtime.holder.objects.foreign import Foreign

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder.record import Record

MOMENTS = {"secs": ("secs", "sec"), "nsecs": ("nsecs", "nanosec")}
CLASSES = {"time": "Time", "duration": "Duration"}


def names(record: Record, field: str) -> tuple[str, ...]:
    """The attribute is called as the field is, but rosbags calls those of moments otherwise."""
    return MOMENTS[field] if record.struct in CLASSES else (field,)


def class_of(owner: type, struct: str) -> type | None:
    """The class that genpy has for a message: beside ``owner``, where both were made at run time, or in the package that has its name."""
    package, _, name = "/".join(name_parts(struct)).rpartition("/")
    beside = getattr(sys.modules.get(owner.__module__), f"_{package}__{name}", None)
    place = "genpy" if struct in CLASSES else f"{package}.msg"
    return beside or getattr(sys.modules.get(place), CLASSES.get(struct, name), None)


OBJECTS = Foreign(names=names, class_of=class_of, besides=frozenset(["structure_needs_at_least_one_member"]))
"""What is particular about them."""
