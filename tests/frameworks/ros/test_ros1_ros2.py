"""Messages of ROS 1 become those of ROS 2, and back, by the names of their fields."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.pipeline.bridge import BridgeBuild
from rosetta_jit.pipeline.request import BridgeRequest, Request

IDL = Path(__file__).resolve().parents[3] / "idl"
TYPES = sorted(f"{path.parent.name}/{path.stem}" for path in (IDL / "ros1").glob("*/*.msg"))
BOTH = [name for name in TYPES if (IDL / "ros2" / name.replace("/", "/msg/")).with_suffix(".msg").exists()]


def build(older):
    one, two = Request("decode", type=older, encoding="ros1"), Request("encode", type=older.replace("/", "/msg/"), encoding="cdr")
    return BridgeBuild(BridgeRequest(one, two))


def test_all_common_types():
    """They meet: lowered, not compiled, since there are a hundred."""
    assert len(BOTH) > 80
    assert all(build(name).halves for name in BOTH)


def bridges(name, backend=None):
    newer = name.replace("/", "/msg/")
    one, two = {"encoding": "ros1", "backend": backend}, {"encoding": "cdr", "backend": backend}
    return rj.Bridge.of(name, newer, decode=one, encode=two), rj.Bridge.of(newer, name, decode=two, encode=one)


@pytest.mark.parametrize("backend", [None, "python"])
def test_names_numbers_and_headers(backend):
    there, back = bridges("sensor_msgs/CameraInfo", backend)
    header = {"seq": 7, "stamp": {"secs": 1_700_000_000, "nsecs": 5}, "frame_id": "left"}
    values = {"header": header, "height": 480, "D": [0.5, 1.5], "K": list(range(9)), "P": list(range(12)), "roi": {"do_rectify": True}}
    older = rj.Encoder.of("sensor_msgs/CameraInfo", encoding="ros1")(values)
    found = rj.Decoder.of("sensor_msgs/msg/CameraInfo", encoding="cdr")(there(older))
    assert (found.header.stamp.sec, found.header.stamp.nanosec, found.header.frame_id) == (1_700_000_000, 5, "left")
    assert (list(found.d), list(found.k), found.roi.do_rectify, found.height) == ([0.5, 1.5], list(range(9)), True, 480)
    again = rj.Decoder.of("sensor_msgs/CameraInfo", encoding="ros1")(back(there(older)))
    assert again.header.seq == 0
    assert np.array_equal(again.P, range(12))
    assert there(back(there(older))) == there(older)


@pytest.mark.parametrize("backend", [None, "python"])
def test_what_ros_2_has_added_is_zero_or_empty(backend):
    there, back = bridges("visualization_msgs/MarkerArray", backend)
    marker = {"ns": "walls", "points": [{"x": 1.5}, {"y": -2.0}], "text": "a"}
    older = rj.Encoder.of("visualization_msgs/MarkerArray", encoding="ros1")({"markers": [marker, {"ns": "doors"}]})
    found = rj.Decoder.of("visualization_msgs/msg/MarkerArray", encoding="cdr")(there(older))
    assert [(each.ns, len(each.points), each.mesh_file.filename, len(each.texture.data)) for each in found.markers] == [
        ("walls", 2, "", 0),
        ("doors", 0, "", 0),
    ]
    assert back(there(older)) == older


def test_nothing_is_left_there_of_a_message_before():
    there, _ = bridges("sensor_msgs/Range")
    first, second = (rj.Encoder.of("sensor_msgs/Range", encoding="ros1")({"range": each}) for each in (1.0, 2.0))
    decode = rj.Decoder.of("sensor_msgs/msg/Range", encoding="cdr")
    assert [(decode(there(each)).range, decode(there(each)).variance) for each in (first, second)] == [(1.0, 0.0), (2.0, 0.0)]


@pytest.mark.parametrize(
    ("name", "values", "path", "why"),
    [
        ("sensor_msgs/Range", {"variance": 0.5}, ".variance", "no such field: must be 0"),
        ("visualization_msgs/Marker", {"texture": {"format": "png"}}, ".texture.format", "must be 0"),
        ("visualization_msgs/Marker", {"uv_coordinates": [{"u": 0.5}]}, ".uv_coordinates", "must be 0"),
        ("shape_msgs/SolidPrimitive", {"polygon": {"points": [{"x": 1.0}]}}, ".polygon.points", "must be 0"),
    ],
)
def test_what_ros_2_has_added_is_never_lost(name, values, path, why):
    _, back = bridges(name)
    newer = rj.Encoder.of(name.replace("/", "/msg/"), encoding="cdr")(values)
    with pytest.raises(rj.EncodeError, match=why) as found:
        back(newer)
    assert found.value.path == path


def test_bytes_that_were_signed():
    """A `byte` has a sign in ROS 1 and none in ROS 2: it is the same eight bits."""
    there, back = bridges("std_msgs/ByteMultiArray")
    older = rj.Encoder.of("std_msgs/ByteMultiArray", encoding="ros1")({"data": [1, -2, -128, 127]})
    assert bytes(rj.Decoder.of("std_msgs/msg/ByteMultiArray", encoding="cdr")(there(older)).data) == b"\x01\xfe\x80\x7f"
    assert back(there(older)) == older


def test_a_number_that_had_no_sign():
    there, back = bridges("std_msgs/Int8")
    assert back(there(b"\xfe")) == b"\xfe"


def test_a_time_that_does_not_fit():
    there, back = bridges("std_msgs/Header")
    late = rj.Encoder.of("std_msgs/Header", encoding="ros1")({"stamp": {"secs": 1 << 31}})
    with pytest.raises(rj.DecodeError, match="does not fit int32") as found:
        there(late)
    assert (found.value.path, found.value.offset) == (".stamp.sec", 4)
    early = rj.Encoder.of("std_msgs/msg/Header", encoding="cdr")({"stamp": {"sec": -1}})
    with pytest.raises(rj.EncodeError, match="does not fit uint32"):
        back(early)


def test_a_mapping_to_a_type_of_ros_1_reaches_ros_2():
    """The data-holder is of ROS 1, and what is written the type of ROS 2 that followed it."""
    rules = """
import "a/State.bottle-schema"
import "ros1/std_msgs/Header.msg"
data-holder: std_msgs/Header
wire-schema: a.State
unpack-rules:
  .seq = 3
  .stamp.secs = uint32(.secs)
  .stamp.nsecs = 0
  .frame_id = .frame
"""
    schema = {"state.mapping": rules, "a/State.bottle-schema": '"a.State"\n( ("secs" :int) ("frame" :string) )\n'}
    bridge = rj.Bridge("state.mapping", encode_type="std_msgs/msg/Header", decode={"encoding": "yarp3", "schema": schema})
    bottle = rj.Encoder.of("a.State", encoding="yarp3", schema={"a/State.bottle-schema": schema["a/State.bottle-schema"]})
    found = rj.Decoder.of("std_msgs/msg/Header", encoding="cdr")(bridge(bottle({"secs": 5, "frame": "arm"})))
    assert (found.stamp.sec, found.frame_id) == (5, "arm")


def test_a_mapping_to_what_has_not_what_ros_2_has_added():
    rules = """
import "a/Echo.bottle-schema"
import "ros1/sensor_msgs/Range.msg"
data-holder: sensor_msgs/Range
wire-schema: a.Echo
pack-rules:
  .distance = .range
"""
    schema = {"echo.mapping": rules, "a/Echo.bottle-schema": '"a.Echo"\n( ("distance" :float32) )\n'}
    with pytest.raises(rj.SchemaError, match=r"`\.variance` the data-holder has no such field"):
        rj.Bridge(None, "echo.mapping", decode_type="sensor_msgs/msg/Range", encode={"encoding": "yarp3", "schema": schema})


def test_differences_are_said():
    there, back = bridges("visualization_msgs/Marker")
    assert there.differences == (
        "`.header.seq` is left out",
        "`.header.stamp.secs` becomes `.header.stamp.sec`",
        "`.header.stamp.secs`: uint32 becomes int32, and a value that does not fit is refused",
        "`.header.stamp.nsecs` becomes `.header.stamp.nanosec`",
        "`.lifetime.secs` becomes `.lifetime.sec`",
        "`.lifetime.nsecs` becomes `.lifetime.nanosec`",
        "`.lifetime.nsecs`: int32 becomes uint32, and a value that does not fit is refused",
        *(f"`.{name}` is zero or empty" for name in ("mesh_file", "texture", "texture_resource", "uv_coordinates")),
    )
    assert back.differences[0] == "`.header.seq` is written as 0"
    assert back.differences[2] == "`.header.stamp.sec`: int32 becomes uint32, and a value that does not fit is refused"
    assert back.differences[-1] == "`.uv_coordinates` is left out, and refused where it is not zero or empty"
    assert rj.Bridge.of("sensor_msgs/msg/Imu", decode={"encoding": "cdr"}, encode={"encoding": "cdr2"}).differences == ()


@pytest.mark.parametrize("backend", ["python", "llvm", "interpreter"])
def test_the_shipped_mapping_does_what_a_bridge_without_one_does(backend):
    """Both types have one name, so that the mappings within it are found by how theirs are written."""
    there, _ = bridges("sensor_msgs/Imu", "python")
    decode, encode = rj.Decoder("ros2/imu.mapping", backend=backend), rj.Encoder("ros2/imu.mapping", backend=backend)
    write = rj.Encoder.of("sensor_msgs/Imu", encoding="ros1", backend="python")
    numbers = np.random.default_rng(3)
    for seconds in (0, 1, 1_700_000_000, 2**31 - 1):
        axes = [dict(zip("xyz", numbers.normal(size=3).tolist(), strict=True)) for _ in range(2)]
        values = {
            "header": {"seq": 0, "stamp": {"secs": seconds, "nsecs": 999_999_999}, "frame_id": "imu_link"},
            "orientation": dict(zip("xyzw", numbers.normal(size=4).tolist(), strict=True)),
            "orientation_covariance": numbers.normal(size=9).tolist(),
            "angular_velocity": axes[0],
            "linear_acceleration": axes[1],
        }
        newer = bytes(encode(encode.holder_type.from_dict(values)))
        assert newer == bytes(there(write(values)))
        assert bytes(write(decode(newer))) == bytes(write(values))
    laws = decode.mapping.laws
    assert (laws.messages.kind, [loss.place for loss in laws.holders.losses]) == ("exact", [".header.seq"])
    with pytest.raises(rj.EncodeError, match=r"stamp"):
        encode(encode.holder_type.from_dict({**values, "header": {"stamp": {"secs": 2**31, "nsecs": 0}}}))
