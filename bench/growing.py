"""Messages that grow in one way each: in size, in fields, in depth. What the curves are drawn over."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from bench.subjects import Subject


def doubles(size: int) -> Subject:
    """A vector of doubles, of so many bytes in all, 8 at the least: OROCOS's, because nothing stands around it but the count."""
    count = size // 8 - 1
    return Subject(
        "std::vector<double>",
        "rtt-mqueue",
        struct.pack("<Q", count) + np.arange(count, dtype="<f8").tobytes(),
        {"schema": {"numbers.hpp": "struct Empty { int nothing; };"}},
    )


def fields(count: int) -> Subject:
    """A ROS 1 message of so many doubles, each a field."""
    text = "\n".join(f"float64 field{index}" for index in range(count))
    return Subject("bench/Fields", "ros1", np.arange(count, dtype="<f8").tobytes(), {"schema": {"bench/msg/Fields.msg": text}})


def optional_fields(count: int) -> Subject:
    """A protobuf message of so many doubles, each a field with a tag before it."""
    return _tagged_fields("optional", count)


def required_fields(count: int) -> Subject:
    """The same of fields that must be there, which decoders guess."""
    return _tagged_fields("required", count)


def _tagged_fields(label: str, count: int) -> Subject:
    text = "\n".join(f"  {label} double field{index} = {index + 1};" for index in range(count))
    message = b"".join(varint(index + 1 << 3 | 1) + struct.pack("<d", index) for index in range(count))
    return Subject("bench.Fields", "protobuf", message, _proto(f"message Fields {{\n{text}\n}}"))


def nested(depth: int) -> Subject:
    """A ROS 1 message of 64 doubles in structs, so many in one another."""
    inner = "float64[64] values"
    files: dict[str, str] = {"bench/msg/Level0.msg": inner}
    for level in range(1, depth):
        files[f"bench/msg/Level{level}.msg"] = f"bench/Level{level - 1} inner"
    return Subject(f"bench/Level{depth - 1}", "ros1", np.arange(64, dtype="<f8").tobytes(), {"schema": files})


def nested_tagged(depth: int) -> Subject:
    """A protobuf message of one double, so many messages deep."""
    types = ["message Level0 { optional double value = 1; }"]
    message = b"\x09" + struct.pack("<d", 1.5)
    for level in range(1, depth):
        types.append(f"message Level{level} {{ optional Level{level - 1} inner = 1; }}")
        message = b"\x0a" + varint(len(message)) + message
    return Subject(f"bench.Level{depth - 1}", "protobuf", message, _proto("\n".join(types)))


def varint(value: int) -> bytes:
    """As protobuf writes unsigned numbers."""
    groups: list[int] = []
    while value >= 0x80:
        groups.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes((*groups, value))


def _proto(body: str) -> dict[str, Any]:
    return {"schema": {"growing.proto": f"syntax = 'proto2';\npackage bench;\n{body}\n"}}
