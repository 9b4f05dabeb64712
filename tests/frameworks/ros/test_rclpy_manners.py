"""Holders of ROS 2 types against what rosidl_generator_py promises."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.ros2.manners import deserialize_message, serialize_message

TEXT = """int32 LIMIT=5
int32 count 7
string name "arm"
float64[<=3] gains [1.5, 2.5]
string<=5 short
uint8[] data
float64[9] covariance
"""


@pytest.fixture(scope="module")
def cls():
    return rj.Decoder.of("pkg/Settings", encoding="cdr", schema=TEXT).holder_type


def test_fields_and_types(cls):
    assert cls.get_fields_and_field_types() == {
        "count": "int32",
        "name": "string",
        "gains": "sequence<double, 3>",
        "short": "string<5>",
        "data": "sequence<uint8>",
        "covariance": "double[9]",
    }
    joint_state = rj.Decoder.of("sensor_msgs/msg/JointState").holder_type
    assert joint_state.get_fields_and_field_types()["header"] == "std_msgs/Header"
    assert cls.LIMIT == 5


def test_a_new_message_has_the_defaults(cls):
    message = cls()
    assert (message.count, message.name, list(message.gains)) == (7, "arm", [1.5, 2.5])
    assert isinstance(message.covariance, np.ndarray)
    assert message.covariance.shape == (9,)


def test_constructor_and_checks(cls):
    assert cls(count=8).count == 8
    with pytest.raises(TypeError, match="Invalid arguments"):
        cls(weight=1)
    with pytest.raises(ValueError, match="3"):
        cls(gains=[0.0] * 4)
    with pytest.raises(ValueError, match="5"):
        cls(short="longer")


def test_serialisation(cls):
    message = cls(short="abc", data=b"\1\2")
    assert deserialize_message(serialize_message(message), cls) == message
    with pytest.raises(rj.DecodeError):
        deserialize_message(b"\0\1\0\0", cls)


def test_what_a_message_prints():
    assert repr(rj.Decoder.of("geometry_msgs/msg/Point").holder_type(x=1.0)) == "geometry_msgs.msg.Point(x=1.0, y=0.0, z=0.0)"


def test_a_message_without_fields_shows_none():
    empty = rj.Decoder.of("std_msgs/msg/Empty").holder_type
    assert empty.get_fields_and_field_types() == {}
    assert serialize_message(empty()) == bytes([0, 1, 0, 0, 0])
