"""The rules of the three encodings, one each, on bytes written by hand."""

from __future__ import annotations

import struct

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.base import Choices
from rosetta_jit.frameworks.orocos.encoding import encode_type
from rosetta_jit.model.types import Schema
from rosetta_jit.wire.codec import Number
from tests.frameworks.orocos.headers import types

HEADER = """
#include <string>
#include <vector>
enum class Small : int8_t { LOW = -128, HIGH = 127 };
enum class Middle : unsigned short { NONE, MOST = 65535 };
enum Plain { OFF, ON };
struct Joint { int id; float pos; bool ok; };
struct Inner { double value; Joint last; };
struct Outer { char first; Inner inner; };
struct Enums { Small small; Middle middle; Plain plain; Small few[2]; };
struct Mixed { char first; std::vector<Joint> joints; bool flag; std::string text; std::vector<bool> bits; };
struct Texts { std::vector<std::string> names; char fixed[4]; };
struct Tree { int value; std::vector<Tree> children; };
struct Nothing {};
struct Holds { Nothing nothing; int number; };
struct Ends { int number; Joint joints[2]; };
"""
JOINT = struct.pack("<if?", 7, 1.5, True)
JOINT_PADDED = JOINT + bytes(3)


def u64(number):
    return struct.pack("<Q", number)


def programs(type_, encoding, backend="python", **options):
    options = {"schema": {"test.hpp": HEADER}, "encoding": encoding, "backend": backend, **options}
    return rj.Decoder.of(type_, **options), rj.Encoder.of(type_, **options)


@pytest.mark.parametrize(
    ("type_", "encoding", "data"),
    [
        ("Joint", "rtt-mqueue", JOINT),
        ("Joint", "typelib", JOINT),
        ("Joint", "native", JOINT_PADDED),
        ("std::vector<Joint>", "rtt-mqueue", u64(2) + JOINT * 2),
        ("std::vector<Joint>", "typelib", u64(2) + JOINT_PADDED * 2),
        ("Outer", "rtt-mqueue", b"x" + struct.pack("<d", 2.5) + JOINT),
        ("Outer", "typelib", b"x" + bytes(7) + struct.pack("<d", 2.5) + JOINT),
        ("Outer", "native", b"x" + bytes(7) + struct.pack("<d", 2.5) + JOINT_PADDED + bytes(4)),
        ("Ends", "typelib", struct.pack("<i", 1) + JOINT_PADDED * 2),
        ("Mixed", "rtt-mqueue", b"x" + u64(1) + JOINT + b"\1" + u64(2) + b"\xff\0" + u64(3) + b"\1\0\1"),
        ("Texts", "rtt-mqueue", u64(2) + u64(1) + b"a" + u64(0) + b"abc\0"),
        ("Texts", "typelib", u64(2) + u64(1) + b"a" + u64(0) + b"abc\0"),
        ("Enums", "rtt-mqueue", struct.pack("<bHibb", -128, 65535, 1, 127, -1)),
        ("Enums", "native", struct.pack("<bxHibb", -128, 65535, 1, 127, -1) + bytes(2)),
        ("Nothing", "rtt-mqueue", b""),
        ("Nothing", "native", b"\0"),
        ("Holds", "typelib", bytes(4) + struct.pack("<i", 3)),
        ("double", "rtt-mqueue", struct.pack("<d", 0.5)),
        ("std::vector<int>", "rtt-mqueue", u64(2) + struct.pack("<2i", 1, -1)),
        ("std::vector<std::string>", "typelib", u64(1) + u64(2) + b"ab"),
        ("Tree", "rtt-mqueue", struct.pack("<iQiQiQ", 1, 2, 2, 0, 3, 0)),
    ],
)
@pytest.mark.parametrize("backend", ["python", "interpreter"])
def test_bytes(type_, encoding, data, backend):
    decode, encode = programs(type_, encoding, backend)
    assert encode(decode(data)) == data


def test_the_same_when_compiled():
    decode, encode = programs("Mixed", "rtt-mqueue", "numba")
    data = b"x" + u64(1) + JOINT + b"\1" + u64(2) + b"\xff\0" + u64(3) + b"\1\0\1"
    held = decode(data)
    assert [each.id for each in held.joints] == [7]
    assert held.flag is True
    assert np.array_equal(held.bits, [True, False, True])
    assert encode(held) == data


def test_a_bool_is_zero_or_one_unless_it_may_be_anything():
    decode, _ = programs("Joint", "rtt-mqueue")
    with pytest.raises(rj.DecodeError, match="not one of 0, 1"):
        decode(JOINT[:-1] + b"\2")
    found = types(HEADER)
    lenient = encode_type(found["Joint"], Schema(found), "rtt-mqueue", Choices(lenient=frozenset({"bool"}))).attempts[0]
    assert lenient.items[-1] == Number(("ok",), "u8")


def test_a_narrow_enum_is_checked_when_it_is_written():
    decode, encode = programs("Enums", "rtt-mqueue")
    held = decode(struct.pack("<bHibb", 0, 0, 0, 0, 0))
    held.small = 200
    with pytest.raises(rj.EncodeError):
        encode(held)


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (u64(1 << 63) + JOINT, "count"),
        (u64((1 << 64) - 1), "count"),
        (u64(1 << 40), "truncated"),
        (u64(3) + JOINT * 2, "truncated"),
        (u64(1) + JOINT + b"\0", "trailing"),
    ],
)
def test_counts_that_lie(data, kind):
    decode, _ = programs("std::vector<Joint>", "rtt-mqueue")
    with pytest.raises(rj.DecodeError) as caught:
        decode(data)
    assert caught.value.kind == kind


@pytest.mark.parametrize(
    ("type_", "encoding", "code"),
    [
        ("Mixed", "native", "container"),
        ("Texts", "native", "container"),
        ("std::vector<double>", "native", "container"),
        ("Mixed", "typelib", "typelib"),
        ("Tree", "typelib", "typelib"),
    ],
)
def test_what_an_encoding_cannot_carry(type_, encoding, code):
    found = types(HEADER)
    with pytest.raises(SchemaError) as caught:
        encode_type(found[type_], Schema(found), encoding, Choices())
    assert caught.value.diagnostics[0].code == code
    assert caught.value.diagnostics[0].span


def test_structs_that_double_are_refused():
    found = types("struct S0 { int a; };" + "".join(f"struct S{n} {{ S{n - 1} a, b; }};" for n in range(1, 20)))
    with pytest.raises(SchemaError, match="unfolds to more than"):
        encode_type(found["S19"], Schema(found), "native", Choices())


def test_types_as_deep_as_they_may_be():
    text = "#include <vector>\nstruct S0 { int x; };" + "".join(f"struct S{n} {{ std::vector<S{n - 1}> s; }};" for n in range(1, 16))
    options = {"schema": {"deep.hpp": text}, "encoding": "rtt-mqueue", "backend": "interpreter"}
    data = u64(1) * 15 + struct.pack("<i", 5)
    assert rj.Encoder.of("S15", **options)(rj.Decoder.of("S15", **options)(data)) == data


@pytest.mark.parametrize("type_", ["KDL::Frame", "KDL::Twist", "KDL::Wrench", "base::samples::Joints"])
def test_shipped_types(type_):
    decode = rj.Decoder.of(type_, encoding="rtt-mqueue", backend="python")
    encode = rj.Encoder.of(type_, encoding="rtt-mqueue", backend="python")
    held = encode.new()
    assert encode(decode(encode(held))) == encode(held)
