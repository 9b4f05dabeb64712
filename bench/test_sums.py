"""Fields by their sums and differences, turned round to pack, against numpy and against a loop of numba's that writes the same bytes."""

from __future__ import annotations

import numba
import numpy as np

import rosetta_jit as rj
from bench.contest import Contender

CHAPTER = "Mappings"
OURS, BY_HAND, NUMPY = "rosetta_jit", "numba, by hand", "numpy"
AT_MOST = 1.2
COUNT = 10_000
WHAT = f"mapping, {COUNT:,} pairs of wheels by sum and difference, encoded"
FILES = {
    "lab/msg/Wheels.msg": "float64[] left\nfloat64[] right\n",
    "lab/msg/Motion.msg": "float64[] speed\nfloat64[] turn\n",
    "wheels.mapping": """import "lab/msg/Wheels.msg"
import "lab/msg/Motion.msg"
data-holder: lab/msg/Motion
wire-schema: lab/msg/Wheels
rules:
  .speed[] <-> (.right[] + .left[]) * 0.5
  .turn[] <-> (.right[] - .left[]) / 0.4
""",
}
HEAD, GAP = 12, 8
"""Bytes before the numbers of each array: CDR's header, a count and what aligns the numbers; the same without a header."""


@numba.njit
def by_loop(speed, turn, data):
    """One message; lengths are checked, and written."""
    count = speed.shape[0]
    if turn.shape[0] != count or data.shape[0] < HEAD + GAP + 16 * count:
        return -1
    head = data[:HEAD].view(np.uint32)
    head[0], head[1], head[2] = 0x0100, count, 0
    left, rest = data[HEAD : HEAD + 8 * count].view(np.float64), data[HEAD + 8 * count :]
    rest[:GAP].view(np.uint64)[0] = count
    right = rest[GAP : GAP + 8 * count].view(np.float64)
    for i in range(count):
        half = turn[i] * 0.4 * 0.5
        left[i] = speed[i] - half
        right[i] = speed[i] + half
    return HEAD + GAP + 16 * count


def by_numpy(speed, turn, data):
    """The same by whole arrays; what the message says of itself is there."""
    half = turn * 0.2
    left, right = data[HEAD : HEAD + 8 * COUNT].view(np.float64), data[HEAD + GAP + 8 * COUNT :].view(np.float64)
    np.subtract(speed, half, out=left)
    np.add(speed, half, out=right)


def test_sums(effort, compare, record):
    numbers = np.random.default_rng(0)
    decode, encode = (made("wheels.mapping", schema=FILES, encoding="cdr") for made in (rj.Decoder, rj.Encoder))
    read = rj.Decoder.of("lab/msg/Wheels", schema=FILES, imports=["lab/msg/Wheels.msg"], encoding="cdr")
    motion = encode.holder_type.from_dict({"speed": numbers.normal(size=COUNT), "turn": numbers.normal(size=COUNT)})
    message = encode(motion)
    back = decode(message)
    assert np.allclose(back.speed, motion.speed)
    assert np.allclose(back.turn, motion.turn)
    out, found = bytearray(len(message)), np.frombuffer(bytearray(message), np.uint8).copy()
    speed, turn, wheels = np.array(motion.speed), np.array(motion.turn), read(message)
    assert by_loop(speed, turn, found) == len(message)
    for made in (found.tobytes(), bytes(out[: encode.into(motion, out)])):
        assert np.allclose(read(made).left, wheels.left)
        assert np.allclose(read(made).right, wheels.right)
    outcome = compare(
        CHAPTER,
        WHAT,
        [
            Contender(OURS, "ours", "bytes, used again", effort.call(lambda: encode.into(motion, out))),
            Contender(BY_HAND, "limit", "bytes, used again", effort.call(lambda: by_loop(speed, turn, found))),
            Contender(NUMPY, "peer", "bytes, used again", effort.call(lambda: by_numpy(speed, turn, found))),
        ],
    )
    took = f"{outcome.took(OURS).median / 1000:.1f} us"
    record(WHAT, outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba by hand", took)
    record(f"{WHAT}, numpy", outcome.ratio(OURS, NUMPY), AT_MOST, "x numpy", took)
