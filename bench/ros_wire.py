"""The ROS messages that are measured, each described once and written in both of ROS's ways, byte by byte."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

JOINTS, RAYS, POSES, POINTS = 32, 1080, 1000, 100_000
TRANSFORMS, STATUSES, VALUES, MARKERS, CORNERS = 50, 20, 5, 10, 4
"""Of a TFMessage; of a DiagnosticArray, and of each of its statuses; of a MarkerArray, and of each of its markers."""
NUMBERS = np.random.default_rng(0).random(8 * POSES)


@dataclass(slots=True)
class Ros1:
    """ROS 1: everything packed, a text behind its length."""

    data: bytearray = field(default_factory=bytearray)

    def pack(self, form: str, *values: float) -> None:
        """Values of one form each; `struct` says which there are."""
        for each, value in zip(form, values, strict=True):
            self.align(struct.calcsize(each))
            self.data += struct.pack("<" + each, value)

    def align(self, size: int) -> None:
        """Nothing is aligned."""

    def text(self, text: bytes) -> None:
        self.blob(text)

    def blob(self, blob: bytes) -> None:
        self.pack("I", len(blob))
        self.data += blob

    def numbers(self, form: str, count: int, *, counted: bool = False) -> None:
        if counted:
            self.pack("I", count)
        self.align(struct.calcsize(form))
        self.data += NUMBERS[:count].astype(f"<{form}").tobytes()

    def header(self) -> None:
        self.pack("I", 7)
        self.stamp()

    def stamp(self) -> None:
        self.pack("II", 1_700_000_000, 123_456_789)
        self.text(b"base_link")


@dataclass(slots=True)
class Ros2(Ros1):
    """ROS 2: CDR, where each number lies at a multiple of its size behind the four bytes in front, and a text ends in a NUL."""

    data: bytearray = field(default_factory=lambda: bytearray(b"\0\1\0\0"))

    def align(self, size: int) -> None:
        self.data += bytes(-(len(self.data) - 4) % size)

    def text(self, text: bytes) -> None:
        self.blob(text + b"\0")

    def header(self) -> None:
        self.stamp()


def imu(wire: Ros1) -> None:
    wire.header()
    wire.numbers("d", 4 + 9 + 3 + 9 + 3 + 9)


def joint_state(wire: Ros1) -> None:
    wire.header()
    wire.pack("I", JOINTS)
    for number in range(JOINTS):
        wire.text(b"left_arm_joint_%d" % number)
    for _ in range(3):
        wire.numbers("d", JOINTS, counted=True)


def laser_scan(wire: Ros1) -> None:
    wire.header()
    wire.pack("fffffff", *range(7))
    for _ in range(2):
        wire.numbers("f", RAYS, counted=True)


def pose_array(wire: Ros1) -> None:
    wire.header()
    wire.pack("I", POSES)
    wire.numbers("d", 7 * POSES)


def image(wire: Ros1) -> None:
    wire.header()
    wire.pack("II", 480, 640)
    wire.text(b"rgb8")
    wire.pack("BI", 0, 1920)
    wire.blob(noise(480 * 1920))


def point_cloud(wire: Ros1) -> None:
    wire.header()
    wire.pack("III", 1, POINTS, 4)
    for number, name in enumerate((b"x", b"y", b"z", b"intensity")):
        wire.text(name)
        wire.pack("IBI", 4 * number, 7, 1)
    wire.pack("BII", 0, 16, 16 * POINTS)
    wire.blob(noise(16 * POINTS))
    wire.pack("B", 1)


def transforms(wire: Ros1) -> None:
    wire.pack("I", TRANSFORMS)
    for number in range(TRANSFORMS):
        wire.header()
        wire.text(b"left_arm_link_%d" % number)
        wire.numbers("d", 7)


def markers(wire: Ros1) -> None:
    """Lines of a few points, each of its own color."""
    wire.pack("I", MARKERS)
    for number in range(MARKERS):
        wire.header()
        wire.text(b"plan")
        wire.pack("iii", number, 4, 0)
        wire.numbers("d", 10)
        wire.numbers("f", 4)
        wire.pack("iiB", 0, 0, 1)
        for form, each in (("d", 3), ("f", 4)):
            wire.pack("I", CORNERS)
            wire.numbers(form, CORNERS * each)
        wire.text(b"marker_%d" % number)
        wire.text(b"")
        wire.pack("B", 0)


def diagnostics(wire: Ros1) -> None:
    wire.header()
    wire.pack("I", STATUSES)
    for status in range(STATUSES):
        wire.pack("B", status % 3)
        for said in (b"motor %d", b"temperature of motor %d is high", b"board %d"):
            wire.text(said % status)
        wire.pack("I", VALUES)
        for number in range(VALUES):
            wire.text(b"temperature_%d" % number)
            wire.text(b"%d.5" % (30 + status + number))


def written(wire: Ros1, describe: Callable[[Ros1], None]) -> bytes:
    """The bytes of a message."""
    describe(wire)
    return bytes(wire.data)


def noise(size: int) -> bytes:
    return (np.arange(size, dtype=np.int64) * 73 % 251).astype(np.uint8).tobytes()
