"""How a type is named, where its declaration comes from, and what can be said about its encoding."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

POINT = "float64 x\nfloat64 y\nfloat64 z"
POINT_STAMPED = f"""std_msgs/Header header
geometry_msgs/Point point
{"=" * 80}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{"=" * 80}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
{"=" * 80}
MSG: geometry_msgs/Point
{POINT}
"""


@pytest.mark.parametrize(
    "name", ["sensor_msgs/JointState", "sensor_msgs/msg/JointState", "sensor_msgs.msg.JointState", "sensor_msgs::JointState"]
)
@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_names_are_one_however_they_are_written(name, encoding):
    holder = rj.Decoder.of(name, encoding=encoding, backend="interpreter").holder_type
    assert holder is rj.Decoder.of("sensor_msgs/JointState", encoding=encoding, backend="interpreter").holder_type
    assert holder.__name__ == "JointState"


def test_the_name_alone_tells_the_framework():
    """ROS 2 has `msg` in the middle; what has no time in its header is ROS 1's."""
    assert rj.Decoder.of("std_msgs/msg/Header", backend="interpreter").new().to_dict().keys() == {"stamp", "frame_id"}
    assert rj.Decoder.of("std_msgs/Header", backend="interpreter").new().to_dict().keys() == {"seq", "stamp", "frame_id"}
    assert rj.Decoder.of("std_msgs/Header", framework="ros2", backend="interpreter").new().to_dict().keys() == {"stamp", "frame_id"}


def test_the_text_that_a_bag_carries():
    options = {"encoding": "cdr", "schema": POINT_STAMPED, "backend": "interpreter"}
    decode, encode = rj.Decoder.of("geometry_msgs/msg/PointStamped", **options), rj.Encoder.of("geometry_msgs/msg/PointStamped", **options)
    holder = decode.new()
    holder.point.y = 2.5
    assert decode(encode(holder)).point.y == 2.5


def test_a_text_without_a_language_is_refused():
    with pytest.raises(rj.SchemaError, match="nothing says in which language"):
        rj.Decoder.of("geometry_msgs/Point", schema=POINT)


@pytest.mark.parametrize(
    ("name", "files"),
    [
        ("a.t", {"a.lcm": "package a; struct t { int32_t n; double v[n]; }"}),
        ("a::T", {"a.idl": "module a { struct T { sequence<double> v; }; };"}),
        ("a.T", {"a.proto": "syntax = 'proto3'; package a; message T { repeated double v = 1; }"}),
        ("a/T", {"a/msg/T.msg": "float64[] v"}),
        ("a::T", {"a.hpp": "#include <vector>\nnamespace a { struct T { std::vector<double> v; }; }"}),
    ],
)
def test_every_suffix_is_read(name, files):
    decode, encode = rj.Decoder.of(name, schema=files, backend="interpreter"), rj.Encoder.of(name, schema=files, backend="interpreter")
    holder = decode.new()
    if name == "a.t":
        holder.n = 2
    if name == "a.T":
        holder.v.extend([1.0, -0.0])
    else:
        holder.v = [1.0, -0.0]
    assert list(decode(encode(holder)).v) == [1.0, -0.0]


@pytest.mark.parametrize("order", ["little", "big"])
def test_byte_orders(order):
    encode = rj.Encoder.of("geometry_msgs/Point", encoding="cdr", byte_order=order)
    holder = encode.holder_type()
    holder.x = 1.5
    data = encode(holder)
    assert data[1] == (order == "little")
    assert rj.Decoder.of("geometry_msgs/Point", encoding="cdr")(data).x == 1.5  # either, since messages say which
    other = rj.Decoder.of("geometry_msgs/Point", encoding="cdr", byte_order="big" if order == "little" else "little")
    with pytest.raises(rj.DecodeError, match="constant"):
        other(data)


def test_a_byte_order_that_cannot_be_chosen_is_refused():
    with pytest.raises(rj.SchemaError, match="one byte order"):
        rj.Encoder.of("geometry_msgs/Point", encoding="ros1", byte_order="big")


def test_leniencies_are_named():
    data = bytes([0, 1, 0, 0, 2])
    with pytest.raises(rj.DecodeError, match="not one of 0, 1"):
        rj.Decoder.of("std_msgs/Bool", encoding="cdr")(data)
    assert rj.Decoder.of("std_msgs/Bool", encoding="cdr", lenient=["bool"])(data).data is True
    with pytest.raises(rj.SchemaError, match="cannot be lenient about `booleans`"):
        rj.Decoder.of("std_msgs/Bool", encoding="cdr", lenient=["booleans"])


def test_lenient_text_keeps_its_bytes():
    data = bytes([0, 1, 0, 0, 3, 0, 0, 0, 0xFF, 0x41, 0])
    with pytest.raises(rj.DecodeError, match="UTF-8"):
        rj.Decoder.of("std_msgs/String", encoding="cdr")(data)
    holder = rj.Decoder.of("std_msgs/String", encoding="cdr", lenient=["text"])(data)
    assert holder.data == "\udcffA"
    assert rj.Encoder.of("std_msgs/String", encoding="cdr", lenient=["text"])(holder) == data


def test_unknown_options_are_refused():
    with pytest.raises(TypeError, match="unknown option 'endian'"):
        rj.Decoder.of("std_msgs/Bool", endian="big")
    with pytest.raises(rj.SchemaError, match="there is no framework `ros3`"):
        rj.Decoder.of("std_msgs/Bool", framework="ros3")
