"""Bags of ROS 1 become logs of ROS 2: rosbags reads there what it wrote here."""

from __future__ import annotations

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import rosetta_jit as rj
from rosetta_jit.cli import main

from .made import time_of

ONE, TWO = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)
ONE.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms\n", "tf2_msgs/msg/TFMessage"))


def header(number):
    stamp = ONE.types["builtin_interfaces/msg/Time"](sec=1_700_000_000 + number, nanosec=number)
    return ONE.types["std_msgs/msg/Header"](seq=number, stamp=stamp, frame_id=f"frame {number}")


def messages(number):
    """A camera's calibration, whose fields have capitals in ROS 1, and transforms, whose headers are in an array."""
    kinds = ONE.types
    region = kinds["sensor_msgs/msg/RegionOfInterest"](x_offset=1, y_offset=2, height=3, width=4, do_rectify=True)
    arrays = {name: np.arange(size, dtype=np.float64) + number for name, size in (("D", number), ("K", 9), ("R", 9), ("P", 12))}
    info = kinds["sensor_msgs/msg/CameraInfo"](
        header(number), height=480, width=640, distortion_model="plumb", binning_x=0, binning_y=5, roi=region, **arrays
    )
    vector = kinds["geometry_msgs/msg/Vector3"](x=1.0, y=2.0, z=float(number))
    turn = kinds["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
    transform = kinds["geometry_msgs/msg/Transform"](translation=vector, rotation=turn)
    stamped = [kinds["geometry_msgs/msg/TransformStamped"](header(each), f"child {each}", transform) for each in range(number)]
    return {"/info": info, "/tf": kinds["tf2_msgs/msg/TFMessage"](stamped)}


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    path = tmp_path_factory.mktemp("bag") / "a.bag"
    writer = Writer(path)
    writer.chunk_threshold = 2000
    with writer:
        connections = {topic: writer.add_connection(topic, each.__msgtype__, typestore=ONE) for topic, each in messages(0).items()}
        for number in range(6):
            for topic, each in messages(number).items():
                writer.write(connections[topic], time_of(number), ONE.serialize_ros1(each, each.__msgtype__))
    return path


def test_the_values_are_the_same(bag, tmp_path):
    assert main(["convert", str(bag), "--to", "ros2", "-o", str(tmp_path / "a.mcap")]) == 0
    with (tmp_path / "a.mcap").open("rb") as file:
        read = [(channel.topic, schema, message) for schema, channel, message in make_reader(file).iter_messages()]
    assert [each.log_time for _, _, each in read] == [time_of(number) for number in range(6) for _ in range(2)]
    for place, (topic, schema, message) in enumerate(read):
        wanted = messages(place // 2)[topic]
        own = get_types_from_msg(schema.data.decode(), schema.name)
        assert own[schema.name][1] == TWO.fielddefs[schema.name][1]
        found = TWO.deserialize_cdr(message.data, schema.name)
        if topic == "/info":
            assert np.array_equal(found.k, wanted.K)
            assert np.array_equal(found.d, wanted.D)
            assert (found.roi.width, found.distortion_model, found.header.frame_id) == (4, "plumb", wanted.header.frame_id)
        else:
            assert [(each.child_frame_id, each.header.stamp.nanosec, each.transform.translation.z) for each in found.transforms] == [
                (each.child_frame_id, each.header.stamp.nanosec, each.transform.translation.z) for each in wanted.transforms
            ]
    assert rj.open(tmp_path / "a.mcap")["/tf"].count == 6


def test_a_byte_is_the_same_eight_bits(tmp_path):
    """ROS 1 reads its `byte` with a sign, and ROS 2 without one; an int8 is a number in both."""
    kinds, path = ONE.types, tmp_path / "bytes.bag"
    layout = kinds["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    sent = {
        "/bytes": kinds["std_msgs/msg/ByteMultiArray"](layout, np.array([-1, 0, 127, -128], np.int8)),
        "/level": kinds["diagnostic_msgs/msg/DiagnosticStatus"](level=-2, name="n", message="m", hardware_id="h", values=[]),
        "/numbers": kinds["std_msgs/msg/Int8MultiArray"](layout, np.array([-1, 5], np.int8)),
    }
    with Writer(path) as writer:
        for topic, each in sent.items():
            connection = writer.add_connection(topic, each.__msgtype__, typestore=ONE)
            writer.write(connection, 1, ONE.serialize_ros1(each, each.__msgtype__))
    assert main(["convert", str(path), "--to", "ros2", "-o", str(tmp_path / "bytes.mcap")]) == 0
    log = rj.open(tmp_path / "bytes.mcap")
    assert bytes(next(iter(log["/bytes"])).data) == b"\xff\x00\x7f\x80"
    assert log["/level"]["level"].tolist() == [254]
    assert next(iter(log["/numbers"])).data.tolist() == [-1, 5]


def test_what_has_no_successor(bag, tmp_path, capsys):
    """A type that ROS 2 does not have; one that has not all fields; messages that are not of ROS 1."""
    types = get_typestore(Stores.EMPTY)
    types.register(get_types_from_msg("int32 x\nint32 y\n", "own_msgs/msg/P"))
    path = tmp_path / "own.bag"
    with Writer(path) as writer:
        connection = writer.add_connection("/p", "own_msgs/msg/P", typestore=types)
        writer.write(connection, 1, types.serialize_ros1(types.types["own_msgs/msg/P"](1, 2), "own_msgs/msg/P"))
    convert = ["convert", str(path), "--to", "ros2", "-o", str(tmp_path / "own.mcap"), "--search-path", str(tmp_path)]
    assert main(convert) == 1
    assert "no definition of own_msgs/msg/P" in capsys.readouterr().err
    folder = tmp_path / "own_msgs" / "msg"
    folder.mkdir(parents=True)
    for text, said in (("int32 x\n", "`.y`"), ("int32 x\nint32 y\nint32 z\n", "`.z`"), ("int32 x\nint32 y\n", "")):
        (folder / "P.msg").write_text(text)
        assert main(convert) == bool(said)
        assert said in capsys.readouterr().err
    assert rj.open(tmp_path / "own.mcap")["/p"]["y"].tolist() == [2]
    again = ["convert", str(tmp_path / "own.mcap"), "--to", "ros2", "-o", str(tmp_path / "again.mcap")]
    assert main(again) == 1
    assert "those of ROS 1 alone" in capsys.readouterr().err
    assert not (tmp_path / "again.mcap").exists()
