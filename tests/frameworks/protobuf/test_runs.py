"""Arrays of numbers of a fixed size behind tags: a run of them is read by a loop of its own."""

from __future__ import annotations

import random
import re
import struct

import pytest

import rosetta_jit as rj

SCALARS = {"double": "d", "float": "f", "fixed32": "I", "sfixed32": "i", "fixed64": "Q", "sfixed64": "q"}
FILE = """syntax = "proto3"; package t;
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
