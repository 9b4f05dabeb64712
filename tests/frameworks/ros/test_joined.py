"""The shipped mappings of several wires: bytes of rosbags in, one by one, the bytes of the whole message out, and back."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj

pytest.importorskip("rosbags")

from tests.frameworks.ros.test_rst_larger import certain
from tests.frameworks.ros.test_rst_pairs import header, numbers, raw, theirs

ODOMETRY = "joined/odometry.mapping"
ARMS = "joined/joint_state.mapping"
LEFT = ["left_shoulder", "left_elbow", "left_wrist"]
RIGHT = ["right_shoulder", "right_elbow", "right_wrist"]


def velocity(x=2.0):
    vectors = {name: numbers("Vector3", {"x": x, "y": 0.0, "z": -1.0}) for name in ("linear", "angular")}
    return theirs("geometry_msgs/TwistWithCovariance", twist=theirs("geometry_msgs/Twist", **vectors), covariance=np.arange(36.0))


def messages(x=2.0):
    pose = theirs("geometry_msgs/PoseWithCovarianceStamped", header=header(5, "map"), pose=certain(0.5))
    return raw(pose), raw(theirs("geometry_msgs/TwistWithCovarianceStamped", header=header(6, "base"), twist=velocity(x)))


def test_an_odometry_of_a_pose_and_a_velocity():
    decode, encode = rj.Decoders(ODOMETRY), rj.Encoders(ODOMETRY)
    whole = decode.encoder(encoding="ros1")
    pose, _ = messages()
    decode.pose(pose)
    assert decode.missing == ("velocity",)
    for x in (2.0, 3.0):
        holder = decode.velocity(messages(x)[1])
        odometry = theirs("nav_msgs/Odometry", header=header(5, "map"), child_frame_id="base", pose=certain(0.5), twist=velocity(x))
        assert whole(holder) == raw(odometry)
    assert encode.pose(holder) == pose
    assert decode.ages == {"pose": 2, "velocity": 0}


def test_a_bridge_writes_one_wire():
    odometry = theirs("nav_msgs/Odometry", header=header(5, "map"), child_frame_id="base", pose=certain(0.5), twist=velocity())
    bridge = rj.Bridge(None, ODOMETRY, encode={"wire": "pose"}, decode={"encoding": "ros1"})
    assert bridge(raw(odometry)) == messages()[0]
    with pytest.raises(rj.MappingError, match="several wires"):
        rj.Bridge(None, ODOMETRY)


def joints(names, first, sec=5):
    values = np.arange(first, first + len(names), dtype=np.float64)
    return theirs(
        "sensor_msgs/JointState", header=header(sec, "base"), name=list(names), position=values, velocity=-values, effort=2 * values
    )


def test_a_state_of_all_joints_of_two_arms():
    decode, encode = rj.Decoders(ARMS), rj.Encoders(ARMS)
    left, right = raw(joints(LEFT, 0.0)), raw(joints(RIGHT, 3.0, sec=7))
    decode.right(right)
    holder = decode.left(left)
    assert rj.Encoder.of("sensor_msgs/JointState", encoding="ros1")(holder) == raw(joints([*LEFT, *RIGHT], 0.0))
    assert encode(holder) == {"left": left, "right": raw(joints(RIGHT, 3.0))}
    with pytest.raises(rj.DecodeError, match="the left arm has 2 positions"):
        decode.left(raw(joints(LEFT[:2], 9.0)))
    decode.right(raw(joints(RIGHT, 30.0)))
    with pytest.raises(rj.InvalidHolder):
        holder.position  # noqa: B018 - to read it raises
    assert decode.left(left).position.tolist() == [0.0, 1.0, 2.0, 30.0, 31.0, 32.0]
