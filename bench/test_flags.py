"""Bits of an integer: flags and numbers of each word of an array, against numpy and against a loop of numba's over the same bytes."""

from __future__ import annotations

import numba
import numpy as np

import rosetta_jit as rj
from bench.contest import Contender

CHAPTER = "Mappings"
OURS, BY_HAND, NUMPY = "rosetta_jit", "numba, by hand", "numpy"
AT_MOST = 1.2
COUNT = 10_000
WHAT = f"mapping, flags and numbers in the bits of {COUNT:,} words"
FILES = {
    "lab/msg/Drives.msg": "uint32[] status\n",
    "lab/msg/Flags.msg": "bool[] ready\nbool[] braked\nuint16[] mode\nfloat64[] volts\n",
    "flags.mapping": """import "lab/msg/Drives.msg"
import "lab/msg/Flags.msg"
data-holder: lab/msg/Flags
wire-schema: lab/msg/Drives
rules:
  .ready[] <-> .status[] & 1 != 0
  .braked[] <-> .status[] & 2 != 0
  .mode[] <-> .status[] >> 2 & 63
  .volts[] <-> (.status[] >> 8) * 0.0625
""",
}
HEAD = 8
"""Bytes before the numbers: CDR's header, and their count."""


@numba.njit
def by_loop(data, ready, braked, mode, volts):
    """One message; its encoding and its length are checked."""
    head = data[:HEAD].view(np.uint32)
    if head[0] & 0xFFFF != 0x0100 or data.shape[0] != HEAD + 4 * np.int64(head[1]) or head[1] > ready.shape[0]:
        return False
    status = data[HEAD:].view(np.uint32)
    for i in range(status.shape[0]):
        ready[i] = status[i] & 1 != 0
        braked[i] = status[i] & 2 != 0
        mode[i] = status[i] >> 2 & 63
        volts[i] = (status[i] >> 8) * 0.0625
    return True


def by_numpy(data, ready, braked, mode, volts):
    """The same by whole arrays; what the message says of itself is not looked at."""
    status = data[HEAD:].view(np.uint32)
    np.not_equal(status & 1, 0, out=ready)
    np.not_equal(status & 2, 0, out=braked)
    np.bitwise_and(status >> 2, 63, out=mode, casting="unsafe")
    np.multiply(status >> 8, 0.0625, out=volts)


def test_flags(effort, compare, record):
    status = np.random.default_rng(0).integers(0, 2**32, COUNT).astype(np.uint32)
    message = np.array([0x0100, COUNT], "<u4").tobytes() + status.tobytes()
    decode, encode = (made("flags.mapping", schema=FILES, encoding="cdr") for made in (rj.Decoder, rj.Encoder))
    holder = decode(message)
    assert encode(holder) == message
    found = np.empty(COUNT, bool), np.empty(COUNT, bool), np.empty(COUNT, np.uint16), np.empty(COUNT)
    data = np.frombuffer(message, np.uint8)
    for way in (by_loop, by_numpy):
        way(data, *found)
        assert all(map(np.array_equal, (holder.ready, holder.braked, holder.mode, holder.volts), found))
    outcome = compare(
        CHAPTER,
        WHAT,
        [
            Contender(OURS, "ours", "an object, used again", effort.call(lambda: decode.into(message, holder))),
            Contender(BY_HAND, "limit", "arrays, used again", effort.call(lambda: by_loop(data, *found))),
            Contender(NUMPY, "peer", "arrays, used again", effort.call(lambda: by_numpy(data, *found))),
        ],
    )
    took = f"{outcome.took(OURS).median / 1000:.1f} us"
    record(WHAT, outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba by hand", took)
    record(f"{WHAT}, numpy", outcome.ratio(OURS, NUMPY), AT_MOST, "x numpy", took)
