"""The types of ROS 2 that follow types of ROS 1: `sensor_msgs/Imu` became `sensor_msgs/msg/Imu`, and its fields were renamed by rule.

Names are in lower case (`K` became `k`), `time` is `builtin_interfaces/Time` with other names, and a header has no `seq`. Some types have
got new fields: they are zero or empty in what comes from ROS 1, and must be so in what goes there.
"""

from __future__ import annotations

from collections.abc import Collection

from rosetta_jit.frameworks.ros import gathered
from rosetta_jit.frameworks.ros2.empty import DUMMY
from rosetta_jit.frameworks.ros2.idl import ROS2
from rosetta_jit.model.types import Struct
from rosetta_jit.parsing.idl import Load
from rosetta_jit.wire.other_type import Partners, UnlikeError

RENAMED = {"sec": "secs", "nanosec": "nsecs"}
DROPPED = frozenset({"seq", DUMMY})
"""Fields that only one of them has: the number of a header in ROS 1, and what stands for nothing in ROS 2."""

ADDED = {
    "sensor_msgs/Range": frozenset({"variance"}),
    "shape_msgs/SolidPrimitive": frozenset({"polygon"}),
    "visualization_msgs/Marker": frozenset({"texture_resource", "texture", "uv_coordinates", "mesh_file"}),
}
"""What ROS 2 has added to types of ROS 1, in its releases up to Kilted."""

LINE = "=" * 80


def successor(type_: str) -> str:
    """The name of a type in ROS 2."""
    package, _, short = type_.rpartition("/")
    return f"{package}/msg/{short}"


def predecessor(field: str, there: Collection[str]) -> str | None:
    """Of the fields of a struct of ROS 1, the one that became a field of ROS 2; None if none did."""
    if field in there:
        return field
    if RENAMED.get(field) in there:
        return RENAMED[field]
    return next((each for each in there if each.lower() == field), None)


def fields_of(older: Struct, newer: Struct, shown: str) -> Partners:
    """For a struct of ROS 1 and the one of ROS 2 that followed it: what became of each field of the older one, and what was added.

    Raises
    ------
    UnlikeError
        A field has no successor, or none that it comes from.
    """
    there = [each.name for each in older.fields]
    added = ADDED.get(older.name, frozenset())
    origins = {each.name: None if each.name in added else predecessor(each.name, there) for each in newer.fields}
    for name, origin in origins.items():
        if origin is None and name not in DROPPED and name not in added:
            raise UnlikeError(f"{shown}.{name}", "nothing of the message is called so")
    found: dict[str, str | None] = dict.fromkeys(there) | {origin: name for name, origin in origins.items() if origin is not None}
    for name, became in found.items():
        if became is None and name not in DROPPED:
            raise UnlikeError(f"{shown}.{name}", "the other type has no such field")
    return Partners(found, added)


def definition(type_: str, load: Load) -> str | None:
    """The definition of a type of ROS 2 as bags carry it, with those of all that it needs; None if it is not on the search path.

    Raises
    ------
    SchemaError
        A definition is wrong, or one that it needs is missing.
    """
    package, _, short = type_.partition("/msg/")
    places = (f"{folder}{name}.msg" for folder in ("ros2/", "") for name in (type_, f"{package}/{short}"))
    source = next((found for found in map(load, places) if found is not None), None)
    if source is None:
        return None
    found = {each.name: each.text for each in gathered(source, load, ROS2).definitions}
    own = found.pop(type_, source.text)
    return "\n".join([own, *(f"{LINE}\nMSG: {name.replace('/msg/', '/')}\n{text}" for name, text in found.items())])
