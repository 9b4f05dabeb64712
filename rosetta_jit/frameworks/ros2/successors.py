"""The types of ROS 2 that follow types of ROS 1: `sensor_msgs/Imu` became `sensor_msgs/msg/Imu`, and its fields were renamed by rule.

Names are in lower case (`K` became `k`), `time` is `builtin_interfaces/Time` with other names, and a header has no `seq`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros import gathered
from rosetta_jit.frameworks.ros2.idl import ROS2

if TYPE_CHECKING:
    from collections.abc import Collection

    from rosetta_jit.parsing.idl import Load

RENAMED = {"sec": "secs", "nanosec": "nsecs"}
DROPPED = frozenset({"seq"})
"""Fields of ROS 1 that have no successor: the number of a header."""

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
