"""Signals in frames of a CAN bus and parts of texts, against loops of numba's over the same bytes, and against Python's own `split`."""

from __future__ import annotations

import numba
import numpy as np

import rosetta_jit as rj
from bench.contest import Contender

CHAPTER = "Mappings"
OURS, BY_HAND, PYTHON = "rosetta_jit", "numba, by hand", "Python"
AT_MOST = 1.2
COUNT = 10_000
FRAMES = {
    "lab/msg/Frame.msg": "uint32 id\nuint8[8] data\n",
    "lab/msg/Bus.msg": "Frame[] frames\n",
    "lab/msg/Motion.msg": "float64[] speed\nint32[] angle\n",
    "frames.mapping": """import "lab/msg/Bus.msg"
import "lab/msg/Motion.msg"
data-holder: lab/msg/Motion
wire-schema: lab/msg/Bus
unpack-rules:
  .speed[] = signal(.frames[].data, "7|16@0+") * 0.01
  .angle[] = int32(signal(.frames[].data, "20|13@1-"))
  ignore rest
""",
}
TEXTS = {
    "lab/msg/Line.msg": "string line\n",
    "lab/msg/Reading.msg": "string sensor\nfloat64 value\nint64 count\n",
    "line.mapping": """import "lab/msg/Line.msg"
import "lab/msg/Reading.msg"
data-holder: lab/msg/Reading
wire-schema: lab/msg/Line
rules:
  .sensor <-> part(.line, ";", 0)
  .value <-> number(part(.line, ";", 1))
  .count <-> integer(part(.line, ";", 2))
""",
}
FRAME = 12
"""Bytes of a frame: its number, and eight of data."""


@numba.njit
def signals_by_loop(data, speed, angle):
    """One message of ROS 1; its length is checked."""
    count = data[:4].view(np.uint32)[0]
    if data.shape[0] != 4 + FRAME * np.int64(count) or count > speed.shape[0]:
        return False
    for i in range(count):
        at = 4 + FRAME * i + 4
        speed[i] = (np.int64(data[at]) << 8 | np.int64(data[at + 1])) * 0.01
        raw = (np.int64(data[at + 2]) | np.int64(data[at + 3]) << 8 | np.int64(data[at + 4]) << 16) >> 4 & 0x1FFF
        angle[i] = raw - (raw >> 12 << 13)
    return True


def test_signals(effort, compare, record):
    what = f"mapping, two signals of each of {COUNT:,} frames"
    decode = rj.Decoder("frames.mapping", schema=FRAMES, encoding="ros1")
    frames = np.random.default_rng(0).integers(0, 256, COUNT * FRAME).astype(np.uint8)
    message = np.uint32(COUNT).tobytes() + frames.tobytes()
    data, speed, angle = np.frombuffer(message, np.uint8), np.empty(COUNT), np.empty(COUNT, np.int32)
    assert signals_by_loop(data, speed, angle)
    held = decode(message)
    assert np.array_equal(held.speed, speed)
    assert np.array_equal(held.angle, angle)
    outcome = compare(
        CHAPTER,
        what,
        [
            Contender(OURS, "ours", "an object of another type, used again", effort.call(decode, message)),
            Contender(BY_HAND, "limit", "two arrays, used again", effort.call(signals_by_loop, data, speed, angle)),
        ],
    )
    record(what, outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba by hand", f"{outcome.took(OURS).median / 1000:.1f} us")


def parts_by_hand(message):
    """The text of a message of ROS 1, and its parts."""
    if len(message) != 4 + int.from_bytes(message[:4], "little"):
        return None
    sensor, value, count = message[4:].decode().split(";")
    return sensor, float(value), int(count)


def test_parts_of_a_text(effort, compare, record):
    what = "mapping, a text, a float and an integer out of the parts of a line"
    decode, encode = (made("line.mapping", schema=TEXTS, encoding="ros1") for made in (rj.Decoder, rj.Encoder))
    message = bytes(encode(encode.holder_type.from_dict({"sensor": "left_wrist", "value": 0.12345678901, "count": 1234567})))
    held = decode(message)
    assert (held.sensor, held.value, held.count) == parts_by_hand(message)
    outcome = compare(
        CHAPTER,
        what,
        [
            Contender(OURS, "ours", "an object of another type, used again", effort.call(decode, message)),
            Contender(PYTHON, "peer", "three objects", effort.call(parts_by_hand, message)),
        ],
    )
    record(what, outcome.ratio(OURS, PYTHON), AT_MOST, "x Python's split", f"{outcome.took(OURS).median:.0f} ns")
