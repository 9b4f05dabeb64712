"""Filters: elements that are kept, in every backend as a comprehension of Python keeps them, and as numpy's masks do."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.explain.operations import operations

SCHEMAS = {
    "lab/msg/Point.msg": "float32 x\nfloat32 y\nfloat32 z\n",
    "lab/msg/Row.msg": "float64[] cells\n",
    "lab/msg/In.msg": "lab/Point[] points\nfloat64[] ranges\nint64[] ids\nstring[] names\nRow[] rows\nuint8[] data\nint32 least\n",
    "lab/msg/Out.msg": "lab/Point[] points\nfloat64[] ranges\nint32[] ids\nfloat64[] every\nuint8[] data\n",
    "h.proto": """syntax = "proto2"; package lab;
message Spot { required float x = 1; required float y = 2; optional float z = 3; }
message Row { repeated double cells = 1; }
message Out { repeated Spot points = 1; repeated double ranges = 2; repeated int32 ids = 3; repeated string names = 4;
  repeated Row rows = 5; repeated double every = 6; repeated int64 at = 7; required bytes data = 8; }""",
    "spot.mapping": """import "lab/msg/Point.msg"
import "h.proto"
data-holder: lab.Spot
wire-schema: lab/msg/Point
rules:
  .x <-> .x
  .y <-> .y
  .z <-> .z
""",
}
RULES = """
  .points[].x = .points[].x where isfinite(.points[].x) and not isnan(.points[].y) and .points[].z > 0
  .points[].z = .points[].z where isfinite(.points[].x) and not isnan(.points[].y) and .points[].z > 0
  .ranges = .ranges where .ranges[] < 1.0
  .points[].y = 2 * .points[].y where isfinite(.points[].x) and not isnan(.points[].y) and .points[].z > 0
  .ids[] = int32(.ids[]) where .ranges[] < 1.0 and .ids[] >= .least
  .names = .names where .names[] != "off"
  .rows[].cells = .rows[].cells where len(.rows[].cells) > 1
  .every = .ranges[0 to] where index() % 3 == 0
  .at[] = index() where .ranges[] < 1.0
  .data = .data where .data[] != 7
"""
HEAD = 'import "lab/msg/In.msg"\nimport "h.proto"\ndata-holder: lab.Out\nwire-schema: lab/msg/In\nunpack-rules:'
EMPTY = {"points": [], "ranges": [], "ids": [], "names": [], "rows": [], "data": b"", "least": -(2**31)}


@pytest.fixture(scope="module", params=["llvm", "python", "interpreter"])
def decode(request):
    return rj.Decoder("m.mapping", schema={**SCHEMAS, "m.mapping": HEAD + RULES}, backend=request.param)


@pytest.fixture(scope="module")
def write():
    program = rj.Encoder.of("lab/msg/In", schema=SCHEMAS, imports=["lab/msg/In.msg"], backend="python")
    return lambda **fields: program(program.holder_type.from_dict({**EMPTY, **fields}))


def expected(fields):
    points = [p for p in fields["points"] if math.isfinite(p["x"]) and not math.isnan(p["y"]) and p["z"] > 0]
    near = [r < 1.0 for r in fields["ranges"]]
    return {
        "points": [{"x": p["x"], "y": 2 * p["y"], "z": p["z"]} for p in points],
        "ranges": [r for r in fields["ranges"] if r < 1.0],
        "ids": [i for i, is_near in zip(fields["ids"], near, strict=True) if is_near and i >= fields["least"]],
        "names": [n for n in fields["names"] if n != "off"],
        "rows": [row for row in fields["rows"] if len(row["cells"]) > 1],
        "every": fields["ranges"][::3],
        "at": [number for number, is_near in enumerate(near) if is_near],
        "data": bytes(b for b in fields["data"] if b != 7),
    }


def some(chance):
    count = chance.choice([0, 1, 2, 7, 30])
    floats = [0.5, 2.0, -1.0, math.inf, math.nan, 0.0]
    points = [{name: chance.choice(floats) for name in "xyz"} for _ in range(chance.choice([0, 1, 5, 20]))]
    rows = [{"cells": [float(chance.randrange(9)) for _ in range(chance.randrange(4))]} for _ in range(chance.randrange(6))]
    return {
        "points": points,
        "ranges": [chance.choice([0.25, 0.5, 1.0, 3.0, math.nan]) for _ in range(count)],
        "ids": [chance.randrange(-100, 100) for _ in range(count)],
        "names": [chance.choice(["off", "", "elbow", "öff"]) for _ in range(chance.randrange(9))],
        "rows": rows,
        "data": bytes(chance.choice([7, 8, 9]) for _ in range(chance.randrange(20))),
        "least": chance.choice([-200, 0, 200]),
    }


def test_keeps_what_a_comprehension_keeps(decode, write):
    chance = random.Random(22)
    for _ in range(60):
        fields = some(chance)
        assert repr(decode(write(**fields)).to_dict()) == repr(expected(fields))


def test_a_batch_keeps_each_messages_own(decode, write):
    chance = random.Random(23)
    given = [some(chance) for _ in range(20)]
    found = decode.many([write(**fields) for fields in given])
    assert [repr(row.to_dict()) for row in found] == [repr(expected(fields)) for fields in given]


def test_an_element_that_is_dropped_is_not_converted(decode, write):
    far = {"ranges": [5.0, 0.5], "ids": [2**40, 7]}
    assert list(decode(write(**far)).ids) == [7]
    with pytest.raises(rj.DecodeError) as error:
        decode(write(ranges=[5.0, 0.5], ids=[7, 2**40]))
    assert (error.value.kind, error.value.path) == ("range", ".ids[0]")


def test_arrays_of_other_lengths_are_rejected(decode, write):
    with pytest.raises(rj.DecodeError) as error:
        decode(write(ranges=[0.5, 0.5], ids=[1]))
    assert error.value.kind == "rejected"


def test_no_message_cut_short_is_taken(decode, write):
    whole = write(**some(random.Random(3)))
    for end in range(0, len(whole), 7):
        with pytest.raises(rj.DecodeError):
            decode(whole[:end])


PACKED = """import "lab/msg/Out.msg"
import "h.proto"
data-holder: lab.Out
wire-schema: lab/msg/Out
pack-rules:
  ignore rest
  .ranges = .ranges where .ranges[] < 1.0
  .ids = .ids where .ids[] > 0
  .every = .every where index() % 2 == 1
  .data = .data where .data[] != 7
  .points = .points via "spot.mapping" where has(.points[].z)
"""


@pytest.mark.parametrize("backend", ["llvm", "interpreter"])
def test_filters_where_it_packs(backend):
    files = {**SCHEMAS, "m.mapping": PACKED}
    encode = rj.Encoder("m.mapping", schema=files, backend=backend)
    read = rj.Decoder.of("lab/msg/Out", schema=SCHEMAS, imports=["lab/msg/Out.msg"], backend="interpreter")
    held = {
        "points": [{"x": 1.0, "y": 2.0, "z": 3.0}, {"x": 1.0, "y": 2.0}, {"x": 4.0, "y": 5.0, "z": 6.0}],
        "ranges": [0.5, 1.5, 0.25],
        "ids": [-1, 4, 0, 9],
        "every": [0.0, 1.0, 2.0, 3.0, 4.0],
        "data": b"\x07a\x07b",
    }
    found = read(encode(encode.holder_type.from_dict(held))).to_dict()
    assert found == {
        "points": [held["points"][0], held["points"][2]],
        "ranges": [0.5, 0.25],
        "ids": [4, 9],
        "every": [1.0, 3.0],
        "data": b"ab",
    }


@pytest.mark.parametrize("backend", ["numba", "python"])
def test_filters_bytes_of_a_protobuf_message(backend):
    """Its elements have no fixed places: it is staged."""
    files = {
        f"{package}.proto": f'syntax = "proto3"; package {package}; message P {{ int32 n = 1; }} '
        f"message {name} {{ repeated double a = 1 [packed = false]; repeated P p = 2; }}"
        for package, name in (("w", "In"), ("h", "Out"))
    }
    files |= {
        "m.mapping": 'import "w.proto"\nimport "h.proto"\ndata-holder: h.Out\nwire-schema: w.In\nunpack-rules:\n'
        "  .a = .a where .a[] > 0\n  .p[].n = .p[].n where .p[].n % 2 == 0\n"
        "pack-rules:\n  .a = .a where .a[] > 1\n  .p[].n = .p[].n where .p[].n > 0\n",
    }
    decode, encode = (each("m.mapping", schema=files, backend=backend) for each in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("w.In", schema=files, imports=["w.proto"], backend="interpreter")
    sent = {"a": [1.0, -1.0, 3.0], "p": [{"n": n} for n in (0, 1, 2, 3)]}
    held = decode(write(write.holder_type.from_dict(sent)))
    assert held.to_dict() == {"a": [1.0, 3.0], "p": [{"n": 0}, {"n": 2}]}
    assert decode(encode(held)).to_dict() == {"a": [3.0], "p": [{"n": 2}]}
    laws = str(decode.mapping.laws)
    assert "messages: lossy" in laws
    assert "holders: lossy" in laws
    assert ".a[]: a filter drops some elements" in laws


def test_filters_within_messages_of_another_mapping():
    """A filter of an array in each element of another one, by a mapping of its own."""
    files = {
        "lab/msg/Part.msg": "float64[] a\nint32[] n\n",
        "lab/msg/Whole.msg": "Part[] parts\n",
        "h.proto": """syntax = "proto3"; package lab;
message Part { repeated double a = 1; repeated int32 n = 2; } message Whole { repeated Part parts = 1; }""",
        "part.mapping": 'import "lab/msg/Part.msg"\nimport "h.proto"\ndata-holder: lab.Part\nwire-schema: lab/msg/Part\n'
        "unpack-rules:\n  .a = .a where .a[] > 0\n  .n = .n where .a[] > 0\n",
        "m.mapping": 'import "lab/msg/Whole.msg"\nimport "h.proto"\ndata-holder: lab.Whole\nwire-schema: lab/msg/Whole\n'
        'unpack-rules:\n  .parts = .parts via "part.mapping" where len(.parts[].a) > 0\n',
    }
    decode = rj.Decoder("m.mapping", schema=files)
    write = rj.Encoder.of("lab/msg/Whole", schema=files, imports=["lab/msg/Whole.msg"])
    parts = [{"a": [1.0, -1.0, 2.0], "n": [1, 2, 3]}, {"a": [], "n": []}, {"a": [-1.0], "n": [4]}]
    found = decode(write(write.holder_type.from_dict({"parts": parts}))).to_dict()
    assert found == {"parts": [{"a": [1.0, 2.0], "n": [1, 3]}, {"a": [], "n": []}]}


CLOUD = """import "ros1/sensor_msgs/PointCloud2.msg"
import "h.proto"
data-holder: lab.Out
wire-schema: sensor_msgs/PointCloud2
unpack-rules:
  ignore rest
  default rest
  .ranges[] = numbers(rows(.data[4 to], .width, 4, .point_step), float32)
    where numbers(rows(.data[4 to], .width, 4, .point_step), float32) < 0.5
"""


def test_filters_numbers_among_bytes():
    decode = rj.Decoder("m.mapping", schema={**SCHEMAS, "m.mapping": CLOUD}, encoding="ros1")
    write = rj.Encoder.of("sensor_msgs/PointCloud2", encoding="ros1")
    data = np.random.default_rng(1).random((50, 5)).astype("<f4")
    cloud = {"width": 49, "height": 1, "point_step": 20, "row_step": 1000, "data": data.tobytes()}
    column = data[:49, 1]
    assert np.array_equal(decode(write(write.holder_type.from_dict(cloud))).ranges, column[column < 0.5].astype(float))
    with pytest.raises(rj.DecodeError) as error:
        decode(write(write.holder_type.from_dict({**cloud, "width": 51})))
    assert error.value.kind == "index"


def test_crops_a_cloud():
    decode = rj.Decoder("ros1/point_cloud_crop.mapping", encoding="ros1", parameters={"lower": [0.0, 0.0, -1.0]})
    write = rj.Encoder.of("sensor_msgs/PointCloud", encoding="ros1")
    points = np.random.default_rng(2).normal(0, 8, (200, 3)).astype("f4")
    points[::9, 1] = math.nan
    sent = write(write.holder_type.from_dict({"points": [dict(zip("xyz", point, strict=True)) for point in points.tolist()]}))
    inside = np.all((points >= [0, 0, -1]) & (points <= [10, 10, 3]), axis=1)
    found = [[each.x, each.y, each.z] for each in decode(sent).points]
    assert 0 < len(found) < 100
    assert np.array_equal(np.array(found, "f4"), points[inside])


def test_counts_as_an_operation():
    assert "predicate assignment" in operations("ros1/point_cloud_crop.mapping")


def test_is_explained(capsys):
    assert main(["explain", "ros1/point_cloud_crop.mapping"]) == 0
    assert "elements for which the condition does not hold are dropped" in capsys.readouterr().out
