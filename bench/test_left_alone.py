"""Elements of which a mapping leaves a field alone, and rejections that say what packing writes, against numba's loops and numpy."""

from __future__ import annotations

import numba
import numpy as np

import rosetta_jit as rj
from bench.contest import Contender

CHAPTER = "Mappings"
OURS, BY_HAND, NUMPY = "rosetta_jit", "numba, by hand", "numpy"
AT_MOST = 1.2
COUNT, BYTES = 10_000, 100_000
POINTS = {
    "lab/msg/Point.msg": "float64 x\nfloat64 y\nfloat64 z\nfloat64 intensity\n",
    "lab/msg/Cloud.msg": "Point[] points\n",
    "lab/msg/Axes.msg": "float64[] x\nfloat64[] y\nfloat64[] z\n",
    "cloud.mapping": """import "lab/msg/Cloud.msg"
import "lab/msg/Axes.msg"
data-holder: lab/msg/Axes
wire-schema: lab/msg/Cloud
rules:
  .x[] <-> .points[].x
  .y[] <-> .points[].y
  .z[] <-> .points[].z
  ignore .points[].intensity
""",
}
FRAMES = {
    "lab/msg/Frame.msg": "uint8[] data\nuint8 check\n",
    "lab/msg/Data.msg": "uint8[] data\n",
    "frame.mapping": """import "lab/msg/Frame.msg"
import "lab/msg/Data.msg"
data-holder: lab/msg/Data
wire-schema: lab/msg/Frame
rules:
  .data <-> .data
  reject "damaged" when .check != sum(.data[]) & 255
""",
}
HEAD = 12
"""Bytes before the points: CDR's header, their number, and what aligns them."""

POINT = np.dtype([("x", "f8"), ("y", "f8"), ("z", "f8"), ("intensity", "f8")])


@numba.njit
def points_by_loop(x, y, z, data):
    """One message; lengths are checked, and written."""
    count = x.shape[0]
    if y.shape[0] != count or z.shape[0] != count or data.shape[0] < HEAD + 32 * count:
        return -1
    head = data[:HEAD].view(np.uint32)
    head[0], head[1], head[2] = 0x0100, count, 0
    numbers = data[HEAD : HEAD + 32 * count].view(np.float64)
    for i in range(count):
        numbers[4 * i] = x[i]
        numbers[4 * i + 1] = y[i]
        numbers[4 * i + 2] = z[i]
        numbers[4 * i + 3] = 0.0
    return HEAD + 32 * count


def points_by_numpy(x, y, z, points):
    """The same by whole fields; what the message says of itself is there."""
    points["x"], points["y"], points["z"], points["intensity"] = x, y, z, 0.0


@numba.njit
def frame_by_loop(source, data):
    """One message with its checksum."""
    count = source.shape[0]
    if data.shape[0] < 8 + count + 1:
        return -1
    head = data[:8].view(np.uint32)
    head[0], head[1] = 0x0100, count
    total = 0
    for i in range(count):
        data[8 + i] = source[i]
        total += source[i]
    data[8 + count] = total & 255
    return 8 + count + 1


def frame_by_numpy(source, data):
    """The same; what the message says of itself is there."""
    data[8:-1] = source
    data[-1] = source.sum(dtype=np.uint8)


def compared(compare, record, what, runs):
    """Rows of one contest: ours against the loop, and against numpy."""
    kinds = ((OURS, "ours"), (BY_HAND, "limit"), (NUMPY, "peer"))
    contenders = [Contender(name, kind, "bytes, used again", run) for (name, kind), run in zip(kinds, runs, strict=True)]
    outcome = compare(CHAPTER, what, contenders)
    took = f"{outcome.took(OURS).median / 1000:.1f} us"
    record(what, outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba by hand", took)
    record(f"{what}, numpy", outcome.ratio(OURS, NUMPY), AT_MOST, "x numpy", took)


def test_fields_of_elements_that_have_their_default(effort, compare, record):
    what = f"mapping, {COUNT:,} points of which a field is left alone, encoded"
    encode = rj.Encoder("cloud.mapping", schema=POINTS, encoding="cdr")
    x, y, z = np.random.default_rng(0).normal(size=(3, COUNT))
    axes = encode.holder_type.from_dict({"x": x, "y": y, "z": z})
    message = bytes(encode(axes))
    out, found, other = bytearray(len(message)), np.full(len(message), 7, np.uint8), np.frombuffer(bytearray(message), np.uint8)
    points = other[HEAD:].view(POINT)
    assert points_by_loop(x, y, z, found) == len(message)
    points_by_numpy(x, y, z, points)
    assert found.tobytes() == other.tobytes() == message == bytes(out[: encode.into(axes, out)])
    runs = (
        effort.call(lambda: encode.into(axes, out)),
        effort.call(lambda: points_by_loop(x, y, z, found)),
        effort.call(lambda: points_by_numpy(x, y, z, points)),
    )
    compared(compare, record, what, runs)


def test_a_rejection_that_says_what_a_checksum_is(effort, compare, record):
    what = f"mapping, a checksum of {BYTES:,} bytes that a rejection asks for, encoded"
    encode = rj.Encoder("frame.mapping", schema=FRAMES, encoding="cdr")
    data = np.random.default_rng(0).integers(0, 256, BYTES, np.uint8)
    held = encode.holder_type.from_dict({"data": data.tobytes()})
    message = bytes(encode(held))
    out, found, other = bytearray(len(message)), np.zeros(len(message), np.uint8), np.frombuffer(bytearray(message), np.uint8)
    assert frame_by_loop(data, found) == len(message)
    frame_by_numpy(data, other)
    assert found.tobytes() == other.tobytes() == message == bytes(out[: encode.into(held, out)])
    runs = (
        effort.call(lambda: encode.into(held, out)),
        effort.call(lambda: frame_by_loop(data, found)),
        effort.call(lambda: frame_by_numpy(data, other)),
    )
    compared(compare, record, what, runs)
