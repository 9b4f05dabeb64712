"""Many different messages of a type: a processor learns the branches of one that is repeated, which no robot sends.

Numbers are random, and so are the lengths of texts; counts stay the same, so that a figure is that of a message of a known size.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.subjects import Subject

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.random import Generator

    Make = Callable[[Generator], dict[str, Any]]

COUNT, POSES, TRANSFORMS, STATUSES, VALUES, JOINTS, TEXTS, FIELDS, DOUBLES = 1000, 1000, 50, 20, 5, 32, 1000, 200, 24
LETTERS = "abcdefghijklmnopqrstuvwxyz_/"
KINDS = ("double", "int32", "bool", "string")
PROTO = {
    "touched.proto": 'syntax = "proto3";\npackage touched;\n'
    "message Joints { string name = 1; int64 stamp = 2; repeated double angles = 3; }\n"
    "message Texts { repeated string texts = 1; }\n"
    f"message Fields {{ {' '.join(f'{KINDS[each % 4]} f{each} = {each + 1};' for each in range(FIELDS))} }}\n"
}
WIDE = 1000
WIDE_PROTO = {
    "wide.proto": 'syntax = "proto2";\npackage touched;\n'
    f"message Wide {{ {' '.join(f'optional int64 f{each} = {each + 1};' for each in range(WIDE))} }}\n"
}


@dataclass(frozen=True, slots=True)
class Varied:
    """Messages of one type. ``subject`` has the first of them."""

    subject: Subject
    messages: tuple[bytes, ...]
    plain: tuple[dict[str, Any], ...]

    def holders(self, count: int) -> list[Any]:
        """Holders of the first messages, one of its own each."""
        decode = self.subject.decoder()
        return [decode.into(each, decode.new()) for each in self.messages[:count]]


def varied(type_: str, encoding: str, make: Make, count: int = COUNT, **options: Any) -> Varied:
    """So many messages, each of values that ``make`` draws."""
    subject, random = Subject(type_, encoding, b"", options), np.random.default_rng(0)
    encode, plain = subject.encoder(), tuple(make(random) for _ in range(count))
    made = subject.decoder().holder_type
    messages = tuple(encode(made.from_dict(each)) for each in plain)
    return Varied(Subject(type_, encoding, messages[0], options), messages, plain)


def text(random: Generator) -> str:
    """Five to twenty letters."""
    return "".join(LETTERS[each] for each in random.integers(0, len(LETTERS), random.integers(5, 21)))


def texts(random: Generator, count: int) -> list[str]:
    return [text(random) for _ in range(count)]


def _numbers(random: Generator, count: int) -> list[float]:
    return random.random(count).tolist()


def _integer(random: Generator) -> int:
    return int(random.integers(1, 1 << 30))


def _named(random: Generator, names: str) -> dict[str, float]:
    return dict(zip(names, _numbers(random, len(names)), strict=True))


def _header(random: Generator, version: int) -> dict[str, Any]:
    secs, nsecs, frame = _integer(random), _integer(random) % 10**9, text(random)
    if version == 1:
        return {"seq": _integer(random), "stamp": {"secs": secs, "nsecs": nsecs}, "frame_id": frame}
    return {"stamp": {"sec": secs, "nanosec": nsecs}, "frame_id": frame}


def _imu(random: Generator, version: int) -> dict[str, Any]:
    parts = {"orientation": "xyzw", "angular_velocity": "xyz", "linear_acceleration": "xyz"}
    found: dict[str, Any] = {"header": _header(random, version)}
    for name, names in parts.items():
        found |= {name: _named(random, names), f"{name}_covariance": _numbers(random, 9)}
    return found


def _joint_state(random: Generator, version: int, joints: int = JOINTS) -> dict[str, Any]:
    arrays = {name: _numbers(random, joints) for name in ("position", "velocity", "effort")}
    return {"header": _header(random, version), "name": texts(random, joints), **arrays}


def _pose_array(random: Generator, version: int) -> dict[str, Any]:
    poses = [{"position": _named(random, "xyz"), "orientation": _named(random, "xyzw")} for _ in range(POSES)]
    return {"header": _header(random, version), "poses": poses}


def _transform(random: Generator) -> dict[str, Any]:
    moved = {"translation": _named(random, "xyz"), "rotation": _named(random, "xyzw")}
    return {"header": _header(random, 1), "child_frame_id": text(random), "transform": moved}


def _status(random: Generator) -> dict[str, Any]:
    values = [{"key": text(random), "value": text(random)} for _ in range(VALUES)]
    return {"level": 1, "name": text(random), "message": text(random), "hardware_id": text(random), "values": values}


def _field(random: Generator, kind: str) -> Any:
    match kind:
        case "double":
            return float(random.random())
        case "int32":
            return _integer(random) >> int(random.integers(0, 25)) or 1
        case "bool":
            return True
        case _:
            return text(random)


@cache
def imu(version: int) -> Varied:
    """Of ROS 1 or 2, as all that say a version."""
    return _ros("sensor_msgs", "Imu", version, lambda random: _imu(random, version))


@cache
def joint_state(version: int) -> Varied:
    return _ros("sensor_msgs", "JointState", version, lambda random: _joint_state(random, version))


@cache
def many_names() -> Varied:
    """Joints with a thousand names, and nothing else."""
    return _ros("sensor_msgs", "JointState", 1, lambda random: {"name": texts(random, TEXTS)}, 50)


@cache
def pose_array(version: int) -> Varied:
    return _ros("geometry_msgs", "PoseArray", version, lambda random: _pose_array(random, version), 20)


@cache
def transforms() -> Varied:
    return _ros("tf2_msgs", "TFMessage", 1, lambda random: {"transforms": [_transform(random) for _ in range(TRANSFORMS)]}, 100)


@cache
def diagnostics() -> Varied:
    return _ros(
        "diagnostic_msgs",
        "DiagnosticArray",
        1,
        lambda random: {"header": _header(random, 1), "status": [_status(random) for _ in range(STATUSES)]},
        100,
    )


@cache
def quaternion() -> Varied:
    return _ros("geometry_msgs", "Quaternion", 2, lambda random: _named(random, "xyzw"))


@cache
def string() -> Varied:
    return _ros("std_msgs", "String", 2, lambda random: {"data": text(random)})


@cache
def joints() -> Varied:
    """protobuf: a text, a number and 24 doubles."""

    def make(random: Generator) -> dict[str, Any]:
        return {"name": text(random), "stamp": _integer(random), "angles": _numbers(random, DOUBLES)}

    return varied("touched.Joints", "protobuf", make, schema=PROTO)


@cache
def many_texts() -> Varied:
    """protobuf: a thousand texts."""
    return varied("touched.Texts", "protobuf", lambda random: {"texts": texts(random, TEXTS)}, 50, schema=PROTO)


@cache
def many_fields() -> Varied:
    """protobuf: two hundred fields, of four kinds in turn."""
    kinds = {f"f{number}": KINDS[number % 4] for number in range(FIELDS)}
    return varied(
        "touched.Fields", "protobuf", lambda random: {name: _field(random, kind) for name, kind in kinds.items()}, 200, schema=PROTO
    )


@cache
def very_many_fields() -> Varied:
    """protobuf: a thousand optional integers, of which nine of ten are there."""

    def make(random: Generator) -> dict[str, Any]:
        return {f"f{number}": int(random.integers(1, 5000)) for number in range(WIDE) if random.random() < 0.9}

    return varied("touched.Wide", "protobuf", make, 50, schema=WIDE_PROTO)


@cache
def lcm_doubles() -> Varied:
    """LCM: a number and 24 doubles."""

    def make(random: Generator) -> dict[str, Any]:
        return {"timestamp": _integer(random), "n": DOUBLES, "values": _numbers(random, DOUBLES)}

    return varied("rjtest.doubles_t", "lcm", make)


def _ros(package: str, name: str, version: int, make: Make, count: int = COUNT) -> Varied:
    return varied(f"{package}/{name}" if version == 1 else f"{package}/msg/{name}", "ros1" if version == 1 else "cdr", make, count)
