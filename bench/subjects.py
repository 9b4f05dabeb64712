"""One message of each kind that the frameworks are measured with."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import rosetta_jit as rj
from bench import ros_wire
from bench.ros_wire import NUMBERS, Ros1, Ros2, noise, written

if TYPE_CHECKING:
    from collections.abc import Callable

DOUBLES = 1000
ANGLES_PROTO = Path(__file__).with_name("native") / "angles.proto"


@dataclass(frozen=True, slots=True)
class Subject:
    """A message of a type, and what a decoder of it is made with."""

    type: str
    encoding: str
    message: bytes
    options: dict[str, Any] = field(default_factory=dict[str, Any])

    def decoder(self, **options: Any) -> Any:
        return rj.Decoder.of(self.type, encoding=self.encoding, **self.options, **options)

    def encoder(self) -> Any:
        return rj.Encoder.of(self.type, encoding=self.encoding, **self.options)


def _ros(name: str, describe: Callable[[Ros1], None]) -> tuple[Subject, Subject]:
    package, _, type_ = name.partition("/")
    return Subject(name, "ros1", written(Ros1(), describe)), Subject(f"{package}/msg/{type_}", "cdr", written(Ros2(), describe))


def _doubles(count: int) -> bytes:
    return NUMBERS[:count].astype("<f8").tobytes()


IMU, IMU_2 = _ros("sensor_msgs/Imu", ros_wire.imu)
JOINT_STATE, JOINT_STATE_2 = _ros("sensor_msgs/JointState", ros_wire.joint_state)
LASER_SCAN, LASER_SCAN_2 = _ros("sensor_msgs/LaserScan", ros_wire.laser_scan)
POSE_ARRAY, POSE_ARRAY_2 = _ros("geometry_msgs/PoseArray", ros_wire.pose_array)
IMAGE, IMAGE_2 = _ros("sensor_msgs/Image", ros_wire.image)
POINT_CLOUD, POINT_CLOUD_2 = _ros("sensor_msgs/PointCloud2", ros_wire.point_cloud)

TRANSFORMS = Subject("tf2_msgs/TFMessage", "ros1", written(Ros1(), ros_wire.transforms))
MARKERS = Subject("visualization_msgs/MarkerArray", "ros1", written(Ros1(), ros_wire.markers))
DIAGNOSTICS = Subject("diagnostic_msgs/DiagnosticArray", "ros1", written(Ros1(), ros_wire.diagnostics))


def _feedback(count: int) -> Subject:
    elements = b"".join(struct.pack("<BBf", 1, each, 0.5) for each in range(count))
    return Subject("sensor_msgs/JoyFeedbackArray", "ros1", struct.pack("<I", count) + elements)


SHORT = {
    "Float64": Subject("std_msgs/Float64", "ros1", _doubles(1)),
    "Bool": Subject("std_msgs/Bool", "ros1", b"\1"),
    "String, 40 characters": Subject("std_msgs/String", "ros1", struct.pack("<I40s", 40, 40 * b"x")),
    "Polygon, 4 points": Subject("geometry_msgs/Polygon", "ros1", struct.pack("<I12f", 4, *range(12))),
    "JoyFeedbackArray, 4 elements": _feedback(4),
    "JoyFeedbackArray, 2 elements": _feedback(2),
    "Float32MultiArray, one dimension": Subject(
        "std_msgs/Float32MultiArray", "ros1", struct.pack("<IIsIIII3f", 1, 1, b"x", 3, 1, 0, 3, 0.5, 1.5, 2.5)
    ),
}
"""Messages that take a few nanoseconds."""

LCM_DOUBLES = Subject(
    "rjtest.doubles_t",
    "lcm",
    bytes.fromhex("29e473ce1716ca37") + struct.pack(">qi", 1_700_000_000_000_000, DOUBLES) + NUMBERS[:DOUBLES].astype(">f8").tobytes(),
)
_EXAMPLE = struct.pack(">Qq7di", 3987159373929993494, 0, 1, 2, 3, 1, 0, 0, 0, 15) + struct.pack(">15h", *range(15))
LCM_EXAMPLE = Subject("exlcm.example_t", "lcm", _EXAMPLE + struct.pack(">i", 15) + b"example string\0\1")


def _matrices(each: int) -> bytes:
    """Arrays of arrays of arrays of numbers, and arrays of short texts."""
    head, texts = struct.pack(">Q3i", 0x3C0248E7BD699F76, each, each, each), 2 * each * struct.pack(">i3s", 3, b"ab\0")
    return head + struct.pack(f">{each**3}i", *range(each**3)) + texts


LCM_MATRICES = Subject("lcmtest.multidim_array_t", "lcm", _matrices(10))
LCM_BOOLS = Subject("lcmtest.bools_t", "lcm", struct.pack(">Q4?2b", 2567030712253961991, True, False, True, True, 6, 6) + 42 * b"\1")


def _nodes(depth: int) -> bytes:
    """A message with three within it, and so on."""
    return struct.pack(">i", 3) + 3 * _nodes(depth - 1) if depth else bytes(4)


LCM_NODES = Subject("exlcm.node_t", "lcm", bytes.fromhex("31fe946c75d6e4e7") + _nodes(4))
FLAGS = 64
FLAGS_T = Path(__file__).with_name("native") / "rj" / "flags_t.lcm"
LCM_FLAGS = Subject(
    "rj.flags_t",
    "lcm",
    bytes.fromhex("069bf23ae45877df") + struct.pack(">i", FLAGS) + bytes(each % 3 == 0 for each in range(FLAGS)),
    {"schema": {"rj/flags_t.lcm": FLAGS_T.read_text("utf-8")}},
)
CORBA_DOUBLES = Subject(
    "RTC::TimedDoubleSeq",
    "cdr-giop",
    struct.pack("<IIII", 1_700_000_000, 123_456_789, DOUBLES, 0) + _doubles(DOUBLES),
    {"imports": ("openrtm/BasicDataType.idl",), "byte_order": "little"},
)
OROCOS_DOUBLES = Subject(
    "std::vector<double>",
    "rtt-mqueue",
    struct.pack("<Q", DOUBLES) + _doubles(DOUBLES),
    {"schema": {"numbers.hpp": "struct Empty { int nothing; };"}},
)
NUMBERS_OF_BYTES = np.random.default_rng(0)
_ANGLES = {"schema": {"angles.proto": ANGLES_PROTO.read_text("utf-8")}}
RST_ANGLES = Subject(
    "rj.JointAngles", "protobuf", b"".join(b"\x09" + NUMBERS[i : i + 1].astype("<f8").tobytes() for i in range(24)), _ANGLES
)
RST_ANGLES_PACKED = Subject("rj.PackedJointAngles", "protobuf", b"\x0a\xc0\x01" + _doubles(24), _ANGLES)
RST_IMAGE = Subject("rst.vision.Image", "protobuf", b"\x0a\x80\x88\x0e" + noise(320 * 240 * 3) + b"\x10\xc0\x02\x18\xf0\x01")


def _field(number: int, value: int | bytes) -> bytes:
    """A field of protobuf: a varint, or bytes behind their length."""
    head = number << 3 | (0 if isinstance(value, int) else 2)
    return _varint(head) + (_varint(value) if isinstance(value, int) else _varint(len(value)) + value)


def _varint(value: int) -> bytes:
    return bytes([value]) if value < 0x80 else bytes([value & 0x7F | 0x80]) + _varint(value >> 7)


def _integers(type_: str, values: list[int]) -> Subject:
    """An array of integers, each behind its tag or all behind one."""
    packed = "Packed" in type_
    message = _field(1, b"".join(map(_varint, values))) if packed else b"".join(_field(1, value) for value in values)
    return Subject(type_, "protobuf", message, _ANGLES)


INTEGERS, MIXED = 10_000, 20
_ONE_BYTE, _TWO_BYTES = (NUMBERS_OF_BYTES.integers(*bounds, INTEGERS).tolist() for bounds in ((0, 1 << 7), (1 << 7, 1 << 14)))
_ARRAYS = (("behind tags", "rj.Integers"), ("packed", "rj.PackedIntegers"))
VARINTS = {
    f"{INTEGERS:,} integers of {size}, {way}": _integers(type_, values)
    for way, type_ in _ARRAYS
    for size, values in (("one byte", _ONE_BYTE), ("two bytes", _TWO_BYTES))
}
"""Each number takes as many bytes as any other: there is nothing to guess, so that one message may be repeated."""


def _mixed() -> list[int]:
    """As many numbers of one byte as of two, in any order: messages of one size, in which a processor guesses anew."""
    return NUMBERS_OF_BYTES.permutation([*_ONE_BYTE[: INTEGERS // 2], *_TWO_BYTES[: INTEGERS // 2]]).tolist()


MIXED_VARINTS = {
    f"{INTEGERS:,} integers of one byte or two, {way}": tuple(_integers(type_, _mixed()) for _ in range(MIXED)) for way, type_ in _ARRAYS
}
"""Messages that come in turn."""


SEVERAL = 200
_SIZES: list[int] = NUMBERS_OF_BYTES.integers(1, 6, SEVERAL).tolist()
_UP_TO_FIVE = [int(NUMBERS_OF_BYTES.integers(1 << 7 * size - 7, 1 << 7 * size)) for size in _SIZES]
_ZIGZAG: list[int] = NUMBERS_OF_BYTES.integers(0, 1 << 21, SEVERAL).tolist()
OF_EACH_KIND = 50


def _each_kind() -> Subject:
    """Integers of one byte or two, bools, the numbers of an enum, and numbers of a fixed size."""
    one_or_two = (NUMBERS_OF_BYTES.integers(1, 300, OF_EACH_KIND).tolist() for _ in range(6))
    bools, modes = (NUMBERS_OF_BYTES.choice(those, OF_EACH_KIND).tolist() for those in ((0, 1), (0, 1, 300)))
    varints = [b"".join(map(_varint, values)) for values in (*one_or_two, bools, modes)]
    fixed = [struct.pack(f"<{OF_EACH_KIND}{each}", *range(OF_EACH_KIND)) for each in "fdI"]
    return Subject("rj.EachKind", "protobuf", b"".join(_field(number, each) for number, each in enumerate((*varints, *fixed), 1)), _ANGLES)


SEVERAL_VARINTS = {
    f"{SEVERAL} integers of one to five bytes, packed": _integers("rj.PackedIntegers", _UP_TO_FIVE),
    f"{SEVERAL} integers of one to five bytes, behind tags": _integers("rj.Integers", _UP_TO_FIVE),
    f"{SEVERAL} sint32 of mostly three bytes, packed": _integers("rj.PackedSignedIntegers", _ZIGZAG),
    f"{SEVERAL} integers of one byte or two, packed": _integers("rj.PackedIntegers", _mixed()[:SEVERAL]),
    f"{SEVERAL} integers of nine bytes, packed": _integers("rj.PackedIntegers", [(1 << 56) + (each << 30) for each in _ZIGZAG]),
    f"{SEVERAL} negative integers, packed": _integers("rj.PackedIntegers", [(1 << 64) - each - 1 for each in _ZIGZAG]),
    f"{OF_EACH_KIND} numbers of each kind, packed": _each_kind(),
}
"""What control boards and encoders of motors send."""
_TEXTS = {"schema": {"texts.proto": ANGLES_PROTO.with_name("texts.proto").read_text("utf-8")}}
_NAMES = b"".join(_field(1, b"joint_%d" % number * (1 + number % 3)) for number in range(50))
LISTS = {
    "50 short texts": Subject("rj.Texts", "protobuf", _NAMES, _TEXTS),
    "50 short byte strings": Subject("rj.Blobs", "protobuf", _NAMES, _TEXTS),
}


def _thing(number: int) -> bytes:
    position = b"".join(bytes([each << 3 | 1]) + struct.pack("<d", number + each) for each in (1, 2, 3))
    color, confidence = struct.pack("<4f", 0.25, 0.5, 0.75, 1), b"\x29" + struct.pack("<d", 0.5)
    return _field(1, number + 1) + _field(2, b"thing_%d" % number) + _field(3, position) + _field(4, color) + confidence


def _scene(things: int) -> bytes:
    """Messages within a message, a case of a oneof, and a map."""
    weights = (_field(6, _field(1, b"weight_%d" % number) + b"\x11" + struct.pack("<d", number + 1)) for number in range(8))
    camera = _field(1, b"left_camera") + _field(2, 640) + _field(3, 480)
    stamp = _field(1, 1_700_000_000) + _field(2, 123_456_789)
    parts = [_field(1, stamp), _field(2, b"map"), *(_field(3, _thing(number)) for number in range(things)), _field(5, camera)]
    return b"".join([*parts, *weights])


SCENE = Subject("rj.Scene", "protobuf", _scene(20), {"schema": {"scene.proto": ANGLES_PROTO.with_name("scene.proto").read_text("utf-8")}})

SUBJECTS = {
    "Imu": IMU,
    "JointState, 32 joints": JOINT_STATE,
    "LaserScan 1080": LASER_SCAN,
    "PoseArray 1000": POSE_ARRAY,
    "Image 640x480": IMAGE,
    "PointCloud2, 100,000 points": POINT_CLOUD,
    "LCM, 1,000 big-endian doubles": LCM_DOUBLES,
    "RST JointAngles, packed": RST_ANGLES_PACKED,
    "RST JointAngles, unpacked": RST_ANGLES,
    "RST Image 320x240": RST_IMAGE,
    "CORBA TimedDoubleSeq 1000": CORBA_DOUBLES,
    "OROCOS vector<double> 1000": OROCOS_DOUBLES,
}
"""The rows of the table of targets."""

ROS_2 = {
    "Imu, ROS 2": IMU_2,
    "JointState, 32 joints, ROS 2": JOINT_STATE_2,
    "LaserScan 1080, ROS 2": LASER_SCAN_2,
    "PoseArray 1000, ROS 2": POSE_ARRAY_2,
    "Image 640x480, ROS 2": IMAGE_2,
    "PointCloud2, 100,000 points, ROS 2": POINT_CLOUD_2,
}
"""The same data in ROS 2's encoding, where other peers are at home."""
