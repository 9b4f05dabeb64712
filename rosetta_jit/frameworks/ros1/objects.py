"""Objects of the classes that genpy writes, and of those of rosbags."""

from __future__ import annotations

import sys

from rosetta_jit.model.types import name_parts
from rosetta_jit.runtime.holder.objects.foreign import Foreign
from rosetta_jit.runtime.holder.record import Record

MOMENTS = {"secs": ("secs", "sec"), "nsecs": ("nsecs", "nanosec")}
CLASSES = {"time": "Time", "duration": "Duration"}


def attribute_names(record: Record, field: str) -> tuple[str, ...]:
    """The attribute is called as the field is, but rosbags calls those of moments otherwise."""
    return MOMENTS[field] if record.struct in CLASSES else (field,)


def class_of(owner: type, struct: str) -> type | None:
    """The class that genpy has for a message: beside ``owner``, where both were made at run time, or in the package that has its name."""
    package, _, name = "/".join(name_parts(struct)).rpartition("/")
    beside = getattr(sys.modules.get(owner.__module__), f"_{package}__{name}", None)
    place = "genpy" if struct in CLASSES else f"{package}.msg"
    return beside or getattr(sys.modules.get(place), CLASSES.get(struct, name), None)


OBJECTS = Foreign(names=attribute_names, class_of=class_of, besides=frozenset(["structure_needs_at_least_one_member"]))
"""Objects of genpy's classes, and of those of rosbags, which have ROS 2's names for moments, and a field in messages that have none."""
