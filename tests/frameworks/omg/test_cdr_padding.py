"""Padding behind a payload: as much as the options of its header announce (DDS-XTypes 1.3, 7.6.3.1.2), and what ROS 2 does not announce."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

SCHEMA = {"probe/msg/Text.msg": "string text\n"}
HEADER = {"cdr": 1, "cdr2": 7}


def payload(encoding, announced, padding, text="é"):
    data = text.encode() + b"\0"
    return bytes((0, HEADER[encoding], 0, announced)) + len(data).to_bytes(4, "little") + data + padding


def decoder(encoding, **options):
    return rj.Decoder.of("probe/msg/Text", encoding=encoding, schema=SCHEMA, backend="interpreter", **options)


@pytest.mark.parametrize("encoding", HEADER)
@pytest.mark.parametrize(("text", "size"), [("abc", 0), ("é", 1), ("x", 2), ("", 3)])
def test_what_is_announced(encoding, text, size):
    assert decoder(encoding)(payload(encoding, size, b"\xff" * size, text)).text == text
    assert decoder(encoding)(payload(encoding, size | 0xFC, bytes(size), text)).text == text  # other bits mean nothing


def refused(decode, data):
    with pytest.raises(rj.DecodeError) as error:
        decode(data)
    return error.value


@pytest.mark.parametrize("encoding", HEADER)
@pytest.mark.parametrize(("announced", "there", "kind"), [(0, 2, "trailing"), (1, 2, "trailing"), (1, 0, "truncated"), (3, 1, "truncated")])
def test_any_other(encoding, announced, there, kind):
    data = payload(encoding, announced, bytes(there))
    assert refused(decoder(encoding), data).kind == kind
    assert decoder(encoding, lenient=["trailing"])(data).text == "é"


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
@pytest.mark.parametrize(("text", "size"), [("abc", 0), ("é", 1), ("x", 2), ("", 3)])
def test_zeros_that_ros2_does_not_announce(text, size, backend):
    """What a subscriber of ROS 2 is given: RTPS fills its submessages up to a multiple of four bytes."""
    decode = rj.Decoder.of("probe/msg/Text", encoding="cdr", schema=SCHEMA, backend=backend)
    for there in range(6):
        data = payload("cdr", 0, bytes(there), text)
        if there in (0, size):
            assert decode(data).text == text
        else:
            assert refused(decode, data).kind == "trailing"
    for place in range(size):
        others = bytes(number == place for number in range(size))
        assert refused(decode, payload("cdr", 0, others, text)).kind == "trailing"
        assert decoder("cdr", lenient=["trailing"])(payload("cdr", 0, others, text)).text == text


def test_a_message_of_rosbag2():
    """From the bag `multiple_files_0` among rosbag2's own tests."""
    data = bytes.fromhex("00010000050000007465737400000000")
    decode = rj.Decoder.of("std_msgs/msg/String", encoding="cdr", backend="interpreter")
    assert decode(data).data == decode(data[:13]).data == "test"


def test_zeros_must_be_announced_in_xcdr2():
    error = refused(decoder("cdr2"), payload("cdr2", 0, b"\0"))
    assert (error.kind, error.offset) == ("trailing", 11)


@pytest.mark.parametrize("encoding", HEADER)
def test_the_remedy(encoding):
    error = refused(decoder(encoding), payload(encoding, 0, b"\1"))
    assert (error.kind, error.offset) == ("trailing", 11)
    assert error.detail == 'bytes are left over; lenient=["trailing"] forgives up to 3'


@pytest.mark.parametrize("encoding", HEADER)
@pytest.mark.parametrize("lenient", [(), ("trailing",)])
def test_more_than_can_be_announced(encoding, lenient):
    error = refused(decoder(encoding, lenient=lenient), payload(encoding, 0, bytes(4)))
    assert (error.kind, error.detail) == ("trailing", "more than 3 bytes are left over")


@pytest.mark.parametrize(
    ("name", "imports", "detail"),
    [
        ("exlcm.example_t", ["lcm/exlcm/example_t.lcm"], 'bytes are left over; lenient=["trailing"] leaves them alone'),
        ("RTC::TimedDouble", ["openrtm/BasicDataType.idl"], 'bytes are left over; lenient=["trailing"] forgives up to 3'),
        ("std_msgs/String", ["ros1/std_msgs/String.msg"], "bytes are left over"),
    ],
    ids=["lcm", "cdr-giop", "ros1"],
)
def test_the_remedy_of_other_encodings(name, imports, detail):
    encode = rj.Encoder.of(name, imports=imports, backend="interpreter")
    data = bytes(encode(encode.holder_type())) + b"\0"
    error = refused(rj.Decoder.of(name, imports=imports, backend="interpreter"), data)
    assert (error.kind, error.detail) == ("trailing", detail)
    if "lenient" in detail:
        rj.Decoder.of(name, imports=imports, backend="interpreter", lenient=["trailing"])(data)


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
def test_written(backend):
    for encoding, text, expected in [
        ("cdr", "é", payload("cdr", 0, b"")),
        ("cdr2", "é", payload("cdr2", 1, b"\0")),
        ("cdr2", "abc", payload("cdr2", 0, b"", "abc")),
        ("cdr2", "", payload("cdr2", 3, bytes(3), "")),
    ]:
        encode = rj.Encoder.of("probe/msg/Text", encoding=encoding, schema=SCHEMA, backend=backend)
        assert bytes(encode(encode.holder_type(text=text))) == expected
        assert decoder(encoding)(expected).text == text


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
@pytest.mark.parametrize(("text", "size"), [("abc", 0), ("é", 1), ("x", 2), ("", 3)])
def test_written_as_rmw_cyclonedds_publishes(text, size, backend):
    encode = rj.Encoder.of("probe/msg/Text", encoding="cdr", schema=SCHEMA, backend=backend, lenient=["padding"])
    expected = payload("cdr", 0, bytes(size), text)
    assert bytes(encode(encode.holder_type(text=text))) == expected
    assert bytes(encode(decoder("cdr", lenient=["padding"])(expected))) == expected
