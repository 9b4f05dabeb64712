"""Compiled decoders and encoders of ROS 1 against genpy's bytes, and against rosbags over random types."""

from __future__ import annotations

import struct
from math import isnan

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.base import Choices
from rosetta_jit.frameworks.installed import shipped
from rosetta_jit.frameworks.ros1.encoding import encode_type
from rosetta_jit.runtime.holder.classes import Holder
from rosetta_jit.wire.codec import Blob, Number, Seq, Table
from tests.frameworks.ros.random_messages import Definitions
from tests.frameworks.ros.ros_files import alone, ros1_vectors

BACKENDS = ["llvm", "python", "interpreter"]
TYPES = sorted({record["type"] for record in ros1_vectors()["records"]})
LENIENT = next(each for each in shipped() if each.name == "ros1").leniencies.get("ros1", {})


def programs(name, backend, schema, **options):
    options |= {"encoding": "ros1", "backend": backend, "schema": schema}
    return rj.Decoder.of(name, **options), rj.Encoder.of(name, **options)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", TYPES)
def test_bytes_of_the_peer(name, backend):
    vectors = ros1_vectors()
    decode, encode = programs(name, backend, vectors["definitions"][name]["definition"])
    for record in vectors["records"]:
        if record["type"] == name:
            data = bytes.fromhex(record["hex"])
            holder = decode(data)
            assert same(Holder.to_dict(holder), record["value"])
            assert encode(holder) == data


def same(ours, known):
    """Equal down to the sign of a zero; a NaN of the vectors has no payload, but its bytes are compared, too."""
    match known:
        case {"hex": digits}:
            return bytes(ours) == bytes.fromhex(digits)
        case dict():
            return ours.keys() == known.keys() and all(same(ours[name], value) for name, value in known.items())
        case list():
            return len(ours) == len(known) and all(map(same, ours, known))
        case float():
            return (isnan(ours) and isnan(known)) or struct.pack("<d", ours) == struct.pack("<d", known)
        case _:
            return ours == known


@pytest.mark.parametrize("backend", BACKENDS)
def test_payloads_of_nan_survive(backend):
    decode, encode = programs("pkg/Foo", backend, "float32 a\nfloat64 b\nfloat32[2] c\nfloat64[] d")
    data = bytes.fromhex("010080ff0100000000 00f07fefbeadff010080ff01000000efbeadde0000f4ff")
    assert encode(decode(data)) == data


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("text", "data", "kind"),
    [
        ("bool a", b"\x02", "constant"),
        ("bool[] a", b"\x01\0\0\0\x80", "constant"),
        ("string a", b"\x01\0\0\0\xff", "text"),
        ("int8 a", b"", "truncated"),
        ("", b"\0", "trailing"),
        ("string a", b"\x05\0\0\0abc", "truncated"),
        ("float64[] a", b"\xff\xff\xff\xff", "truncated"),
        ("string[2] a", b"\0\0\0\0", "truncated"),
        ("time[3] a", bytes(23), "truncated"),
    ],
)
def test_broken_messages(text, data, kind, backend):
    decode, _ = programs("pkg/Foo", backend, text)
    with pytest.raises(rj.DecodeError) as caught:
        decode(data)
    assert caught.value.kind == kind


def test_what_can_be_forgiven():
    schema = alone("bool a\nstring b")
    strict = encode_type(schema.types["pkg/Foo"], schema, "ros1", Choices()).attempts[0]
    lenient = encode_type(schema.types["pkg/Foo"], schema, "ros1", Choices(lenient=frozenset({"bool", "text"}))).attempts[0]
    assert [type(each) for each in strict.items] == [Table, Blob]
    assert [type(each) for each in lenient.items] == [Number, Blob]
    assert isinstance(lenient, Seq)


@pytest.mark.skipif("bool" not in LENIENT, reason="the leniencies of ros1 are not declared")
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_lenient_decoder(backend):
    decode, _ = programs("pkg/Foo", backend, "bool a\nstring b", lenient=["bool", "text"])
    holder = decode(b"\x02\x01\0\0\0\xff")
    assert holder.a
    assert holder.b == "\udcff"


@pytest.mark.parametrize("seed", range(12))
def test_random_types(seed):
    """A random message of a random type: the same bytes as rosbags, and the same values."""
    typesys = pytest.importorskip("rosbags.typesys")
    made = Definitions(seed)
    store = typesys.get_typestore(typesys.Stores.EMPTY)
    store.register(BUILTIN | typesys.get_types_from_msg(made.text, made.name))
    peer = made.name.replace("/", "/msg/")
    decode, encode = programs(made.name, ("python", "llvm", "interpreter")[seed % 3], made.text)
    for _ in range(10):
        data = made.message()
        message = store.deserialize_ros1(data, peer)
        holder = decode(data)
        assert encode(holder) == data == bytes(store.serialize_ros1(message, peer))
        assert alike(Holder.to_dict(holder), message)


BUILTIN = {
    "builtin_interfaces/msg/Time": ([], [("sec", (1, ("int32", 0))), ("nanosec", (1, ("uint32", 0)))]),
    "builtin_interfaces/msg/Duration": ([], [("sec", (1, ("int32", 0))), ("nanosec", (1, ("uint32", 0)))]),
}


def alike(ours, peers):
    """The same values as those of rosbags, whose times are always signed and whose bytes are numbers."""
    match ours:
        case {"secs": seconds, "nsecs": nanoseconds}:
            return (seconds - peers.sec) % (1 << 32) == 0 and (nanoseconds - peers.nanosec) % (1 << 32) == 0
        case dict():
            return all(alike(value, getattr(peers, name)) for name, value in ours.items())
        case bytes() | bytearray():
            return bytes(ours) == peers.tobytes()
        case list():
            return len(ours) == len(peers) and all(map(alike, ours, peers))
        case _:
            return bool(np.array_equal(ours, peers, equal_nan=isinstance(ours, float)))
