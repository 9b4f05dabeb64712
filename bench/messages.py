"""The messages that are measured: as the bundled recordings look, in any number and size."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np

MAPPINGS = Path(__file__).resolve().parent / "mappings"
WIDTH, HEIGHT = 320, 240


def specialised(count: int = 24) -> bytes:
    """A YARP 3 bottle of doubles under one tag: 8 + 8 n bytes."""
    return struct.pack(f"<ii{count}d", 256 + 10, count, *_angles(count))


def tagged(count: int = 16) -> bytes:
    """The same with a tag before each double: 8 + 12 n bytes."""
    return struct.pack("<ii", 256, count) + b"".join(struct.pack("<id", 10, angle) for angle in _angles(count))


def batch(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Many specialised bottles in one buffer, and their n + 1 offsets."""
    return repeated(specialised(), count)


def repeated(message: bytes, count: int) -> tuple[np.ndarray, np.ndarray]:
    """A message many times in one buffer, and the n + 1 offsets."""
    return np.tile(np.frombuffer(message, np.uint8), count), np.arange(count + 1, dtype=np.int64) * len(message)


def anew(message: bytes) -> bytes:
    """The same bytes in another place."""
    return bytes(bytearray(message))


def image(width: int = WIDTH, height: int = HEIGHT) -> bytes:
    """A YARP 3 image as YARP 3.12 writes it, rows padded to the quantum of 8."""
    row = -(-width * 3 // 8) * 8
    size = row * height
    head = struct.pack("<ii i4s i4s ii 5i ii", 256, 4, 9, b"mat\0", 9, b"rgb\0", 257, 5, 3, size, 8 | 1 << 16, width, height, 12, size)
    return head + (np.arange(size) % 251).astype(np.uint8).tobytes()


def joints_mapping(count: int, folder: Path) -> Path:
    """A mapping of so many joints, written to a folder: what first compiles are measured with."""
    fields = "\n".join(f'  ("a{index}" :double (:unit :degree))' for index in range(count))
    (folder / f"joints{count}.bottle-schema").write_text(f'"bench.joints{count}"\n(\n{fields}\n)\n')
    rules = "\n".join(f"  .angles[{index}] = float32(radians(.a{index}))" for index in range(count))
    back = "\n".join(f"  .a{index} = degrees(float64(.angles[{index}]))" for index in range(count))
    path = folder / f"joints{count}.mapping"
    path.write_text(
        f'import "joints{count}.bottle-schema"\nimport "rst/kinematics/JointAngles.proto"\n\n'
        f"data-holder: rst.kinematics.JointAngles\nwire-schema: bench.joints{count}\n\n"
        f"unpack-rules:\n  len(.angles) = {count}\n{rules}\n\npack-rules:\n{back}\n"
    )
    return path


def _declared(count: int, text: str) -> str:
    return "".join(text.format(number=number, next=number + 1) for number in range(count))


def _ros(encoding: str, name: str) -> Callable[[int], tuple[str, dict[str, object]]]:
    def made(count: int) -> tuple[str, dict[str, object]]:
        return f"{name}{count}", {"encoding": encoding, "schema": {f"{name}{count}.msg": _declared(count, "float64 a{number}\n")}}

    return made


def _lcm(count: int) -> tuple[str, dict[str, object]]:
    text = f"package bench; struct Ten{count} {{ {_declared(count, 'double a{number}; ')}}}"
    return f"bench.Ten{count}", {"encoding": "lcm", "schema": {"ten.lcm": text}}


def _protobuf(count: int) -> tuple[str, dict[str, object]]:
    text = f'syntax = "proto3"; package bench; message Ten{count} {{ {_declared(count, "double a{number} = {next}; ")} }}'
    return f"bench.Ten{count}", {"encoding": "protobuf", "schema": {"ten.proto": text}}


def _yarp(count: int) -> tuple[str, dict[str, object]]:
    fields = _declared(count, '("a{number}" :double) ')
    return f"bench.ten{count}", {"encoding": "yarp4", "schema": {"ten.bottle-schema": f'"bench.ten{count}" ({fields})'}}


TYPES = {"ROS 1": _ros("ros1", "bench/Ten"), "ROS 2": _ros("cdr", "bench/msg/Ten"), "LCM": _lcm, "protobuf": _protobuf, "YARP": _yarp}
"""Types of so many doubles, and how they are declared to a decoder, by framework."""


def _angles(count: int) -> list[float]:
    return [10.0 * index - 7.25 for index in range(count)]
