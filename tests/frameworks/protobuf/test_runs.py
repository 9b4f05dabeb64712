"""Arrays of numbers behind tags: a run of them is read by a loop of its own."""

from __future__ import annotations

import random
import re
import struct

import pytest

import rosetta_jit as rj

SCALARS = {"double": "d", "float": "f", "fixed32": "I", "sfixed32": "i", "fixed64": "Q", "sfixed64": "q"}
FILE = """syntax = "proto3"; package t; enum Open {{ NONE = 0; }}
message M {{
  repeated {0} a = 1 [packed = false]; repeated {0} b = 15 [packed = false]; repeated {0} far = 16 [packed = false]; int32 i = 2; N n = 4;
}}
message N {{ repeated {0} a = 1 [packed = false]; }}
"""
WIRE = {4: 5, 8: 1}


def decoder(scalar, **options):
    return rj.Decoder.of("t.M", encoding="protobuf", schema={"t.proto": FILE.format(scalar)}, **options)


def element(scalar, field, value):
    code = SCALARS[scalar]
    tag = field << 3 | WIRE[struct.calcsize(code)]
    return (bytes([tag]) if tag < 128 else bytes([tag & 127 | 128, tag >> 7])) + struct.pack(f"<{code}", value)


def message(scalar, rng):
    """Runs of any length of three arrays, and other fields between them."""
    wanted, data = {"a": [], "b": [], "far": []}, b""
    for _ in range(rng.randrange(1, 8)):
        name, field = rng.choice([("a", 1), ("b", 15), ("far", 16)])
        for _ in range(rng.choice([1, 2, 3, 9, 40])):
            wanted[name].append(rng.randrange(100))
            data += element(scalar, field, wanted[name][-1])
        data += rng.choice([b"", b"\x10\x05", b"\xa0\x06\x07"])
    return wanted, data


@pytest.mark.parametrize("backend", ["llvm", "python"])
@pytest.mark.parametrize("scalar", SCALARS)
def test_runs_between_other_fields(scalar, backend):
    rng = random.Random(scalar)
    for _ in range(60 if backend == "llvm" else 5):
        wanted, data = message(scalar, rng)
        found = decoder(scalar, backend=backend)(data)  # a new one has no room yet
        assert {name: list(getattr(found, name)) for name in wanted} == wanted


@pytest.mark.parametrize("backend", ["llvm", "python"])
def test_every_cut_is_told_where_it_is(backend):
    decode, data = decoder("double", backend=backend), b"".join(element("double", 1, each) for each in range(5))
    decode(data + data)
    for cut in range(len(data)):
        whole, rest = divmod(cut, 9)
        if rest == 0:
            assert list(decode(data[:cut]).a) == [*range(whole)]
        else:
            with pytest.raises(rj.DecodeError, match=re.escape(f"the message ends here - at `.a[{whole}]`, byte {9 * whole + 1}")):
                decode(data[:cut])


def test_a_run_stays_within_its_message():
    """What follows the inner message looks like further elements of it."""
    decode, one = decoder("double"), element("double", 1, 7)
    inner = b"\x22" + bytes([3 * len(one)]) + 3 * one
    found = decode(inner + 2 * one)
    assert (list(found.n.a), list(found.a)) == ([7, 7, 7], [7, 7])
    for short in range(1, 9):
        with pytest.raises(rj.DecodeError, match="goes beyond its message"):
            decode(b"\x22" + bytes([3 * len(one) - short]) + 3 * one + 2 * one)


VARINTS = ("int32", "uint64", "sint32", "sint64", "bool", "Open")


def varint(value):
    return bytes([value]) if value < 128 else bytes([value & 127 | 128]) + varint(value >> 7)


def number(rng, scalar):
    """Of any size, one byte as often as all others together; and what it reads as."""
    size = rng.choice([1, 1, 1, 1, 2, 3, 5, 7, 10])
    raw = rng.randrange(2 if scalar == "bool" else min(1 << 7 * size, 1 << 64))
    low = raw % (1 << (32 if scalar in {"int32", "sint32", "Open"} else 64))
    if scalar.startswith("s"):
        return raw, low >> 1 ^ -(low & 1)
    return raw, low - (1 << 32) if scalar in {"int32", "Open"} and low >> 31 else low


@pytest.mark.parametrize("backend", ["llvm", "python"])
@pytest.mark.parametrize("scalar", VARINTS)
def test_runs_of_varints_between_other_fields(scalar, backend):
    rng, decode = random.Random(scalar), decoder(scalar, backend=backend)
    for _ in range(60 if backend == "llvm" else 5):
        wanted, data = {"a": [], "b": [], "far": []}, b""
        for _ in range(rng.randrange(1, 8)):
            name, field = rng.choice([("a", 1), ("b", 15), ("far", 16)])
            for _ in range(rng.choice([1, 2, 3, 9, 40])):
                raw, value = number(rng, scalar)
                wanted[name].append(value)
                data += varint(field << 3) + varint(raw)
            data += rng.choice([b"", b"\x10\x05", b"\xa0\x06\x07"])
        found = decode(data)
        assert {name: list(getattr(found, name)) for name in wanted} == wanted


@pytest.mark.parametrize("backend", ["llvm", "python"])
@pytest.mark.parametrize("raw", [1, 300, 1 << 28, 1 << 40])
def test_every_cut_of_varints_is_told_where_it_is(raw, backend):
    decode, one = decoder("uint64", backend=backend), b"\x08" + varint(raw)
    for cut in range(9 * len(one)):
        whole, rest = divmod(cut, len(one))
        if rest == 0:
            assert list(decode((9 * one)[:cut]).a) == whole * [raw]
        else:
            with pytest.raises(rj.DecodeError, match=re.escape(f"the message ends here - at `.a[{whole}]`, byte {cut}")):
                decode((9 * one)[:cut])


def test_a_run_of_varints_stays_within_its_message():
    """What follows the inner message looks like further elements of it."""
    decode, one = decoder("uint64"), b"\x08\x07"
    for count in range(1, 12):
        found = decode(b"\x22" + bytes([2 * count]) + count * one + 9 * one)
        assert (list(found.n.a), list(found.a)) == (count * [7], 9 * [7])
        with pytest.raises(rj.DecodeError, match="goes beyond its message"):
            decode(b"\x22" + bytes([2 * count - 1]) + count * one + 9 * one)
