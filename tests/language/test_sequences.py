"""Arrays made of others: differences, runs and bits, both ways, in every backend as numpy has them."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

import rosetta_jit as rj

SCHEMAS = {
    "lab/msg/In.msg": "int32[] steps\nint8[] values\nuint16[] counts\nuint8[] mask\nbool[] flags\nfloat32[] f\nuint8[] n\nuint8[] high\n",
    "h.proto": """syntax = "proto3"; package lab;
message Out {
  repeated int64 ticks = 1; repeated sint32 cells = 2; repeated bool flags = 3; bytes mask = 4; repeated float f = 5;
  repeated bool high = 6;
}""",
    "m.mapping": """import "lab/msg/In.msg"
import "h.proto"
data-holder: lab.Out
wire-schema: lab/msg/In
rules:
  .ticks <-> running_sums(.steps)
  .cells <-> repeated(.values, .counts)
  .flags <-> bits(.mask)
  .mask <-> bit_bytes(.flags)
  .f <-> repeated(.f, .n)
  .high <-> bits(.high, true)
""",
}
OUT = {"ticks": [], "cells": [], "flags": [], "mask": b"", "f": [], "high": []}
EMPTY = {"steps": [], "values": [], "counts": [], "mask": b"", "flags": [], "f": [], "n": b"", "high": b""}


@pytest.fixture(scope="module", params=["llvm", "python", "interpreter"])
def programs(request):
    return [each("m.mapping", schema=SCHEMAS, backend=request.param) for each in (rj.Decoder, rj.Encoder)]


@pytest.fixture(scope="module")
def wire():
    of = [each.of("lab/msg/In", schema=SCHEMAS, imports=["lab/msg/In.msg"], backend="python") for each in (rj.Encoder, rj.Decoder)]
    return (lambda **fields: of[0](of[0].holder_type.from_dict({**EMPTY, **fields}))), of[1]


def some(chance):
    runs = chance.choice([0, 1, 3, 9])
    octets = [bytes(chance.randrange(256) for _ in range(chance.choice([0, 1, 5, 32]))) for _ in range(2)]
    return {
        "steps": [chance.randrange(-1000, 1000) for _ in range(chance.choice([0, 1, 40]))],
        "values": [chance.randrange(-2, 2) for _ in range(runs)],
        "counts": [chance.choice([0, 1, 2, 50]) for _ in range(runs)],
        "mask": octets[0],
        "flags": [chance.random() < 0.5 for _ in range(8 * chance.randrange(4))],
        "f": [chance.choice([0.0, -0.0, math.nan, 1.5]) for _ in range(runs)],
        "n": bytes(chance.choice([0, 1, 3]) for _ in range(runs)),
        "high": octets[1],
    }


def unpacked(fields):
    return {
        "ticks": np.cumsum(np.array(fields["steps"], np.int64)).tolist(),
        "cells": np.repeat(np.array(fields["values"], int), fields["counts"]).tolist(),
        "flags": np.unpackbits(np.frombuffer(fields["mask"], np.uint8), bitorder="little").astype(bool).tolist(),
        "mask": np.packbits(fields["flags"], bitorder="little").tobytes() if fields["flags"] else b"",
        "f": np.repeat(np.array(fields["f"], np.float32), list(fields["n"])).tolist(),
        "high": np.unpackbits(np.frombuffer(fields["high"], np.uint8)).astype(bool).tolist(),
    }


def runs_of(array):
    """Each run of elements that are the same, floats to the bit."""
    found = []
    for value in array:
        if found and np.float32(value).tobytes() == np.float32(found[-1][0]).tobytes():
            found[-1][1] += 1
        else:
            found.append([value, 1])
    return found


def test_there_and_back(programs, wire):
    decode, encode = programs
    write, read = wire
    chance = random.Random(5)
    for _ in range(40):
        fields = some(chance)
        held = decode(write(**fields))
        assert repr(held.to_dict()) == repr(unpacked(fields))
        packed = encode(held)
        whole = {**fields}
        for values, counts in (("values", "counts"), ("f", "n")):
            runs = runs_of(held.to_dict()["cells" if values == "values" else "f"])
            whole[values] = [value for value, _ in runs]
            whole[counts] = bytes(count for _, count in runs) if counts == "n" else [count for _, count in runs]
        assert repr(read(packed).to_dict()) == repr(whole)
        assert repr(decode(packed).to_dict()) == repr(held.to_dict())


@pytest.mark.parametrize(
    ("fields", "kind", "path"),
    [
        ({"values": [1], "counts": []}, "rejected", ".cells"),
        ({"f": [1.0], "n": b"\x01\x02"}, "rejected", ".f"),
        ({"flags": [True] * 9}, "range", ".mask"),
    ],
)
def test_what_unpacking_refuses(programs, wire, fields, kind, path):
    with pytest.raises(rj.DecodeError) as error:
        programs[0](wire[0](**fields))
    assert (error.value.kind, error.value.path) == (kind, path)


@pytest.mark.parametrize(
    ("fields", "kind", "path"),
    [
        ({"ticks": [5, 5 + 2**31]}, "range", ".steps[1]"),
        ({"ticks": [-(2**63), 2**63 - 1]}, "range", ".steps"),
        ({"cells": [0, 1, 1, 200]}, "range", ".values[2]"),
        ({"f": [0.5] * 256}, "range", ".n[0]"),
        ({"flags": [True] * 7}, "range", ".mask"),
    ],
)
def test_what_packing_refuses(programs, fields, kind, path):
    encode = programs[1]
    with pytest.raises(rj.EncodeError) as error:
        encode(encode.holder_type.from_dict({**OUT, **fields}))
    assert (error.value.kind, error.value.path) == (kind, path)


def test_a_small_message_makes_no_large_array(programs, wire):
    """Twenty runs of 65,535 cells are more than a message of its size may ask for."""
    with pytest.raises(rj.DecodeError) as error:
        programs[0](wire[0](values=[1] * 20, counts=[65535] * 20))
    assert (error.value.kind, error.value.path) == ("count", ".cells")


def test_laws(programs):
    laws = programs[0].mapping.laws
    assert laws.holders.kind == "exact"
    assert {loss.place for loss in laws.messages.losses} == {".values", ".counts", ".f", ".n"}
    assert "runs of the same value come back as one" in str(laws.messages)


def test_negative_runs_and_sums_beyond_64_bits_are_refused(programs):
    files = {
        "lab/msg/In.msg": "int64[] steps\nint64[] counts\n",
        "h.proto": 'syntax = "proto3"; package lab; message Out { repeated int64 a = 1; repeated int64 b = 2; }',
        "m.mapping": 'import "lab/msg/In.msg"\nimport "h.proto"\ndata-holder: lab.Out\nwire-schema: lab/msg/In\n'
        "unpack-rules:\n  .a = running_sums(.steps)\n  .b = repeated(.steps, .counts)\n",
    }
    decode = rj.Decoder("m.mapping", schema=files, backend="interpreter")
    write = rj.Encoder.of("lab/msg/In", schema=files, imports=["lab/msg/In.msg"], backend="interpreter")
    for steps, counts, kind, path in (
        ([2**62, 2**62], [0, 0], "range", ".a"),
        ([1, 2], [3, -1], "count", ".b"),
        ([1, 2], [2**62, 2**62], "range", ".b"),
    ):
        with pytest.raises(rj.DecodeError) as error:
            decode(write(write.holder_type.from_dict({"steps": steps, "counts": counts})))
        assert (error.value.kind, error.value.path) == (kind, path)
