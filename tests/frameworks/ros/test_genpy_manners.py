"""Holders of ROS 1 types against the classes that genpy writes."""

from __future__ import annotations

import io
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import rosetta_jit as rj

SYSTEM_PYTHON = Path("/usr/bin/python3")
THEIRS = """
import io, json
from sensor_msgs.msg import Imu, NavSatStatus
from std_msgs.msg import Header
shown = [[c._type, c._md5sum, c._full_text, c._has_header, list(c.__slots__), list(c._slot_types)] for c in (Imu, NavSatStatus, Header)]
message = Imu()
message.header.stamp.secs, message.header.frame_id, message.angular_velocity.z = 5, "imu", -0.0
buffer = io.BytesIO()
message.serialize(buffer)
print(json.dumps([shown, buffer.getvalue().hex(), NavSatStatus.STATUS_GBAS_FIX]))
"""


def cls(name):
    return rj.Decoder.of(name, encoding="ros1").holder_type


@pytest.fixture(scope="module")
def imu():
    return cls("sensor_msgs/Imu")


def test_what_a_class_says(imu):
    assert (imu._type, imu._md5sum, imu._has_header) == ("sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2", True)
    assert imu.__slots__[2] == "orientation_covariance"
    assert imu._slot_types[2] == "float64[9]"
    assert "MSG: geometry_msgs/Vector3" in imu._full_text


def test_round_trip(imu):
    message, buffer = imu(), io.BytesIO()
    message.header.stamp.set_nsec(5_000_000_007)
    message.orientation_covariance = np.arange(9.0)
    message.serialize(buffer)
    again = imu().deserialize(buffer.getvalue())
    assert again == message
    assert again.header.stamp.to_sec() == pytest.approx(5.000000007)
    assert list(again.orientation_covariance) == list(range(9))


def test_constructors():
    vector = cls("geometry_msgs/Vector3")
    assert vector(1.0, 2.0, 3.0) == vector(x=1.0, y=2.0, z=3.0)
    with pytest.raises(TypeError, match="Invalid number of arguments"):
        vector(1.0)
    with pytest.raises(AttributeError, match="no field 'w'"):
        vector(w=1.0)


def test_constants_and_text():
    status = cls("sensor_msgs/NavSatStatus")
    assert status.STATUS_GBAS_FIX == 2
    assert str(cls("std_msgs/String")(data="a")) == 'data: "a"'


def test_errors_have_a_place(imu):
    with pytest.raises(rj.DecodeError, match="truncated"):
        imu().deserialize(b"\0\0\0")


def test_the_real_classes():
    if not SYSTEM_PYTHON.exists():
        pytest.skip("no Python of the system")
    done = subprocess.run([SYSTEM_PYTHON, "-c", THEIRS], capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip("genpy's messages are not installed")
    shown, data, constant = json.loads(done.stdout)
    for name, md5sum, text, header, slots, types in shown:
        ours = cls(name)
        assert [ours._type, ours._md5sum, ours._has_header, list(ours.__slots__), ours._slot_types] == [name, md5sum, header, slots, types]
        assert without_comments(ours._full_text) == without_comments(text)
    assert constant == cls("sensor_msgs/NavSatStatus").STATUS_GBAS_FIX
    message = cls("sensor_msgs/Imu")().deserialize(bytes.fromhex(data))
    assert (message.header.frame_id, message.header.stamp.secs) == ("imu", 5)
    assert np.signbit(message.angular_velocity.z)


def without_comments(text):
    lines = [line.partition("#")[0].replace("=", " = ").split() for line in text.splitlines()]
    return sorted(words for words in lines if words)
