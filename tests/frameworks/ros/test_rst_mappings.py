"""The shipped mappings between ROS 1 and RST: bytes of rosbags in, values by plain Python, and back."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rosetta_jit as rj

pytest.importorskip("rosbags")

from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS1_NOETIC)
BACKENDS = ["llvm", "python", "interpreter"]


def theirs(name, /, **fields):
    return STORE.types[name](**fields)


def raw(message):
    return bytes(STORE.serialize_ros1(message, message.__msgtype__))


def header():
    return theirs("std_msgs/msg/Header", seq=3, stamp=theirs("builtin_interfaces/msg/Time", sec=5, nanosec=6), frame_id="camera")


def programs(name, backend):
    return tuple(kind(f"ros1/{name}.mapping", encoding="ros1", backend=backend) for kind in (rj.Decoder, rj.Encoder))


@pytest.mark.parametrize("backend", BACKENDS)
def test_pose2d(backend):
    decode, encode = programs("pose2d", backend)
    for theta in (0.0, 0.5, -3.0, math.pi / 2):
        message = raw(theirs("geometry_msgs/msg/Pose2D", x=1.5, y=-2.0, theta=theta))
        pose = decode(message)
        assert (pose.translation.x, pose.translation.y, pose.translation.z) == (1.5, -2.0, 0.0)
        rotation = pose.rotation
        assert (rotation.qw, rotation.qx, rotation.qy, rotation.qz) == (math.cos(theta / 2), 0.0, 0.0, math.sin(theta / 2))
        back = STORE.deserialize_ros1(encode(pose), "geometry_msgs/msg/Pose2D")
        assert (back.x, back.y) == (1.5, -2.0)
        assert back.theta == pytest.approx(theta, abs=1e-12)
    for change in ({"translation": {"x": 0.0, "y": 0.0, "z": 1.0}}, {"rotation": {"qw": 0.0, "qx": 0.0, "qy": 0.0, "qz": 0.0}}):
        flat = {"translation": {"x": 0.0, "y": 0.0, "z": 0.0}, "rotation": {"qw": 1.0, "qx": 0.0, "qy": 0.0, "qz": 0.0}}
        with pytest.raises(rj.EncodeError) as error:
            encode(encode.holder_type.from_dict({**flat, **change}))
        assert error.value.kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
def test_time_reference(backend):
    decode, encode = programs("time_reference", backend)
    moment = theirs("builtin_interfaces/msg/Time", sec=1_700_000_000, nanosec=123_456_789)
    stamp = decode(raw(theirs("sensor_msgs/msg/TimeReference", header=header(), time_ref=moment, source="gps")))
    assert stamp.time == 1_700_000_000_123_456
    back = STORE.deserialize_ros1(encode(stamp), "sensor_msgs/msg/TimeReference")
    assert (back.time_ref.sec, back.time_ref.nanosec, back.source, back.header.seq) == (1_700_000_000, 123_456_000, "", 0)
    stamp.time = (1 << 32) * 1_000_000
    with pytest.raises(rj.EncodeError) as error:
        encode(stamp)
    assert error.value.kind == "range"


@pytest.mark.parametrize("backend", BACKENDS)
def test_joint_state(backend):
    decode, encode = programs("joint_state", backend)
    positions = np.array([0.5, -0.25, 1.0])
    state = theirs(
        "sensor_msgs/msg/JointState", header=header(), name=["a", "b", ""], position=positions, velocity=positions * 2, effort=np.zeros(1)
    )
    angles = decode(raw(state))
    assert list(angles.angles) == list(positions)
    back = STORE.deserialize_ros1(encode(angles), "sensor_msgs/msg/JointState")
    assert list(back.position) == list(positions)
    assert (back.name, len(back.velocity), len(back.effort)) == ([], 0, 0)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("encoding", "channels", "color"), [("mono8", 1, "COLOR_GRAYSCALE"), ("rgb8", 3, "COLOR_RGB"), ("bgr8", 3, "COLOR_BGR")]
)
def test_image(encoding, channels, color, backend):
    decode, encode = programs("image", backend)
    width, height, padding = 5, 3, 2
    rows = np.arange(height * (width * channels + padding), dtype=np.uint8).reshape(height, -1)
    fields = {"height": height, "width": width, "encoding": encoding, "is_bigendian": 0, "step": rows.shape[1], "data": rows.ravel()}
    image = decode(raw(theirs("sensor_msgs/msg/Image", header=header(), **fields)))
    pixels = rows[:, : width * channels]
    assert bytes(image.data) == pixels.tobytes()
    found = image.to_dict()
    assert (found["width"], found["height"], found["channels"], found["color_mode"]) == (width, height, channels, color)
    back = STORE.deserialize_ros1(encode(image), "sensor_msgs/msg/Image")
    assert (back.width, back.height, back.encoding, back.step) == (width, height, encoding, width * channels)
    assert bytes(back.data) == pixels.tobytes()
    image.width = 7
    with pytest.raises(rj.EncodeError, match="do not fill the image"):
        encode(image)
    with pytest.raises(rj.DecodeError, match="no such encoding"):
        decode(raw(theirs("sensor_msgs/msg/Image", header=header(), **{**fields, "encoding": "bayer_rggb8"})))


@pytest.mark.parametrize("backend", BACKENDS)
def test_joints_with_names(backend):
    decode, encode = programs("proprioception", backend)
    state = {"name": ["a", "elbow", ""], "position": np.array([0.5, -0.25, 1.0]), "velocity": np.ones(3), "effort": np.zeros(1)}
    joints = decode.into(raw(theirs("sensor_msgs/msg/JointState", header=header(), **state)), decode.new())
    assert [(bytes(each.name).decode(), each.value) for each in joints.joints] == list(zip(state["name"], state["position"], strict=True))
    back = STORE.deserialize_ros1(encode(joints), "sensor_msgs/msg/JointState")
    assert (back.name, list(back.position), len(back.velocity), len(back.effort)) == (state["name"], list(state["position"]), 0, 0)
    with pytest.raises(rj.DecodeError, match="as many names as positions"):
        decode(raw(theirs("sensor_msgs/msg/JointState", header=header(), **{**state, "name": ["a"]})))
    joints.joints[1].stiffness = 0.0
    with pytest.raises(rj.EncodeError, match="no stiffness"):
        encode(joints)
    odd = encode.holder_type.from_dict({"joints": [{"name": b"\xff", "value": 0.0}]})
    with pytest.raises(rj.EncodeError) as error:
        encode(odd)
    assert error.value.kind == "text"


@pytest.mark.parametrize("backend", BACKENDS)
def test_diagnostic_status(backend):
    decode, encode = programs("diagnostic_status", backend)
    values = [theirs("diagnostic_msgs/msg/KeyValue", key=f"k{number}", value="v" * number) for number in range(5)]
    status = theirs("diagnostic_msgs/msg/DiagnosticStatus", level=2, name="motor", message="hot", hardware_id="m1", values=values)
    found = decode(raw(status)).to_dict()["entries"]
    text = [("name", "motor"), ("message", "hot"), ("hardware_id", "m1"), *((each.key, each.value) for each in values)]
    wanted = [{"key": key, "value": {"type": "STRING", "string": value, "array": []}} for key, value in text]
    assert found == [{"key": "level", "value": {"type": "INT", "int": 2, "array": []}}, *wanted]
    assert encode(decode(raw(status))) == raw(status)
    mixed = [found[number] for number in (4, 3, 1, 5, 6, 0, 7, 2, 8)]
    assert encode(encode.holder_type.from_dict({"entries": mixed})) == raw(status)
    for change, words in (
        (found[1:], "an entry `level`, an integer"),
        (found[:3], "an entry `hardware_id`, a text"),
        ([{**found[0], "value": found[1]["value"]}, *found[1:]], "an entry `level`, an integer"),
        ([*found, found[1]], 'has more than one element whose `.key` is "name"'),
        ([*found, {"key": "x", "value": {"type": "BOOL", "bool": True, "array": []}}], "the value is no text"),
    ):
        with pytest.raises(rj.EncodeError, match=words):
            encode(encode.holder_type.from_dict({"entries": change}))


GOAL_STATES = ["INITIATED", "ACCEPTED", "ABORTED", "COMPLETED", "FAILED", "REJECTED", "ABORT", "ABORT", "ABORTED", "FAILED"]
BACK = {state: GOAL_STATES.index(state) for state in GOAL_STATES}
BACK |= dict.fromkeys(("UPDATE", "UPDATE_REJECTED", "ABORT_FAILED", "RESULT_AVAILABLE"), 1)


@pytest.mark.parametrize("backend", BACKENDS)
def test_goal_status(backend):
    decode, encode = programs("goal_status", backend)
    stamp = theirs("builtin_interfaces/msg/Time", sec=5, nanosec=6)

    def goal(status, name="4294967295"):
        return raw(
            theirs(
                "actionlib_msgs/msg/GoalStatus", goal_id=theirs("actionlib_msgs/msg/GoalID", stamp=stamp, id=name), status=status, text="t"
            )
        )

    for status, state in enumerate(GOAL_STATES):
        found = decode(goal(status)).to_dict()
        assert found == {"origin": "HANDLER", "state": state, "serial": 4294967295, "wire_schema": b"", "payload": b""}
    for state, status in BACK.items():
        task = encode.holder_type.from_dict({"origin": "SUBMITTER", "state": state, "serial": 17, "wire_schema": b"x", "payload": b"y"})
        back = STORE.deserialize_ros1(encode(task), "actionlib_msgs/msg/GoalStatus")
        assert (back.status, back.goal_id.id, back.goal_id.stamp.sec, back.text) == (status, "17", 0, "")
    for broken, kind in ((goal(10), "rejected"), (goal(1, "seven"), "text"), (goal(1, "4294967296"), "range"), (goal(1, ""), "text")):
        with pytest.raises(rj.DecodeError) as error:
            decode(broken)
        assert error.value.kind == kind
