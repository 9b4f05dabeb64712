"""One message of each kind that the frameworks are measured with, written by hand, byte by byte."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field

import numpy as np

JOINTS, RAYS, POSES, POINTS, DOUBLES = 32, 1080, 1000, 100_000, 1000
NUMBERS = np.random.default_rng(0).random(8 * POSES)


@dataclass(frozen=True)
class Subject:
    """A message of a type, and what a decoder of it is made with. ``rosbags`` is the name by which that peer knows the type."""

    type: str
    encoding: str
    message: bytes
    options: dict = field(default_factory=dict)
    rosbags: str = ""


def ros1(type_, body):
    package, name = type_.split("/")
    header = struct.pack("<III", 7, 1_700_000_000, 123_456_789) + text(b"base_link")
    return Subject(type_, "ros1", header + body, rosbags=f"{package}/msg/{name}")


def text(data):
    return struct.pack("<I", len(data)) + data


def doubles(count):
    return NUMBERS[:count].astype("<f8").tobytes()


def counted(count):
    return struct.pack("<I", count) + doubles(count)


def floats(count):
    return struct.pack("<I", count) + NUMBERS[:count].astype("<f4").tobytes()


def noise(size):
    return (np.arange(size, dtype=np.int64) * 73 % 251).astype(np.uint8).tobytes()


def point_field(name, offset):
    return text(name) + struct.pack("<IBI", offset, 7, 1)


NAMES = b"".join(text(b"left_arm_joint_%d" % number) for number in range(JOINTS))
FIELDS = b"".join(point_field(name, 4 * number) for number, name in enumerate((b"x", b"y", b"z", b"intensity")))

IMU = ros1("sensor_msgs/Imu", doubles(4 + 9 + 3 + 9 + 3 + 9))
JOINT_STATE = ros1("sensor_msgs/JointState", struct.pack("<I", JOINTS) + NAMES + 3 * counted(JOINTS))
LASER_SCAN = ros1("sensor_msgs/LaserScan", struct.pack("<7f", *range(7)) + 2 * floats(RAYS))
POSE_ARRAY = ros1("geometry_msgs/PoseArray", struct.pack("<I", POSES) + doubles(7 * POSES))
IMAGE = ros1("sensor_msgs/Image", struct.pack("<II", 480, 640) + text(b"rgb8") + struct.pack("<BI", 0, 1920) + text(noise(480 * 1920)))
POINT_CLOUD = ros1(
    "sensor_msgs/PointCloud2",
    struct.pack("<III", 1, POINTS, 4) + FIELDS + struct.pack("<BII", 0, 16, 16 * POINTS) + text(noise(16 * POINTS)) + b"\1",
)
LCM_DOUBLES = Subject(
    "rjtest.doubles_t",
    "lcm",
    bytes.fromhex("29e473ce1716ca37") + struct.pack(">qi", 1_700_000_000_000_000, DOUBLES) + NUMBERS[:DOUBLES].astype(">f8").tobytes(),
)
CORBA_DOUBLES = Subject(
    "RTC::TimedDoubleSeq",
    "cdr-giop",
    struct.pack("<IIII", 1_700_000_000, 123_456_789, DOUBLES, 0) + doubles(DOUBLES),
    {"imports": ("openrtm/BasicDataType.idl",), "byte_order": "little"},
)
OROCOS_DOUBLES = Subject(
    "std::vector<double>",
    "rtt-mqueue",
    struct.pack("<Q", DOUBLES) + doubles(DOUBLES),
    {"schema": {"numbers.hpp": "struct Empty { int nothing; };"}},
)
ANGLES = b"".join(b"\x09" + NUMBERS[number : number + 1].astype("<f8").tobytes() for number in range(24))
PACKED_ANGLES = b"\x0a\xc0\x01" + doubles(24)
PIXELS = noise(320 * 240 * 3)
RST_IMAGE = Subject("rst.vision.Image", "protobuf", b"\x0a\x80\x88\x0e" + PIXELS + b"\x10\xc0\x02\x18\xf0\x01")


def angles(message, option):
    text = f"syntax = 'proto2'; package rj; message JointAngles {{ repeated double angles = 1 [packed = {option}]; }}"
    return Subject("rj.JointAngles", "protobuf", message, {"schema": {"angles.proto": text}})


RST_ANGLES, RST_ANGLES_PACKED = angles(ANGLES, "false"), angles(PACKED_ANGLES, "true")
