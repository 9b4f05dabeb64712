"""State: a low-pass filter and a difference over many messages, against a loop of numba's that a person wrote for the same messages."""

from __future__ import annotations

import numba
import numpy as np

import rosetta_jit as rj
from bench.contest import Contender

CHAPTER = "State"
OURS, STATELESS, BY_HAND = "rosetta_jit", "rosetta_jit, without state", "numba, by hand"
AT_MOST, AT_MOST_PLAIN = 1.2, 1.2
"""The loop by hand knows beforehand where each number lies; a decoder looks at each message anew, and `many` takes microseconds."""

COUNT = 10_000
SHARE, RATE = 0.1, 100.0
HEAD = 'import "lab/msg/Joint.msg"\nimport "lab/msg/Motion.msg"\ndata-holder: lab/msg/Motion\nwire-schema: lab/msg/Joint\n'
FILES = {
    "lab/msg/Joint.msg": "float64 position\nint64 seq\n",
    "lab/msg/Motion.msg": "float64 speed\nfloat64 smooth\nint64 seq\n",
    "filter.mapping": f"""{HEAD}state last: float64 = 0.0
state smooth: float64 = 0.0
unpack-rules:
  .speed = (.position - last) * {RATE}
  .smooth = smooth + {SHARE} * (.position - smooth)
  .seq = .seq
  state last = .position
  state smooth = smooth + {SHARE} * (.position - smooth)
""",
    "plain.mapping": f"""{HEAD}unpack-rules:
  .speed = (.position - 0.5) * {RATE}
  .smooth = 0.5 + {SHARE} * (.position - 0.5)
  .seq = .seq
""",
}
MESSAGE = 20
"""Bytes of a message: CDR's header of four, and two numbers."""


RECORD = np.dtype([("header", "<u4"), ("position", "<f8"), ("seq", "<i8")])


@numba.njit
def filtered(records, offsets, speed, smooth, seq):
    """All messages, whose size is known beforehand; that each is where the offsets say, and of this encoding, is checked."""
    last, low = 0.0, 0.0
    for i in range(offsets.shape[0] - 1):
        if offsets[i] != i * MESSAGE or offsets[i + 1] - offsets[i] != MESSAGE or records[i].header & 0xFFFF != 0x0100:
            return i
        position = records[i].position
        speed[i] = (position - last) * RATE
        low = low + SHARE * (position - low)
        smooth[i] = low
        seq[i] = records[i].seq
        last = position
    return offsets.shape[0] - 1


def test_against_numba(effort, compare, record):
    write = rj.Encoder.of("lab/msg/Joint", schema=FILES, imports=["lab/msg/Joint.msg"], encoding="cdr")
    positions = np.random.default_rng(0).normal(size=COUNT).cumsum()
    sent = [write(write.holder_type.from_dict({"position": float(at), "seq": seq})) for seq, at in enumerate(positions)]
    assert {len(each) for each in sent} == {MESSAGE}
    data, offsets = b"".join(sent), np.arange(COUNT + 1) * MESSAGE
    decode, plain = (rj.Decoder(f"{name}.mapping", schema=FILES, encoding="cdr") for name in ("filter", "plain"))
    batch, other = decode.many(data, offsets), plain.many(data, offsets)
    found = np.empty(COUNT), np.empty(COUNT), np.empty(COUNT, np.int64)
    assert filtered(np.frombuffer(data, RECORD), offsets, *found) == COUNT
    assert np.array_equal(batch.smooth, found[1])

    def ours(program, into):
        return effort.call(lambda: program.many(data, offsets, into=into), messages=COUNT)

    records = np.frombuffer(data, RECORD)
    outcome = compare(
        CHAPTER,
        f"{COUNT:,} messages of two numbers",
        [
            Contender(OURS, "ours", "a batch, used again", ours(decode, batch)),
            Contender(STATELESS, "ours", "a batch, used again", ours(plain, other)),
            Contender(BY_HAND, "peer", "three columns", effort.call(filtered, records, offsets, *found, messages=COUNT)),
        ],
    )
    took = f"{outcome.took(OURS).median:.1f} ns a message"
    record("a low-pass filter and a difference", outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba", took)
    record("a mapping with state", outcome.ratio(OURS, STATELESS), AT_MOST_PLAIN, "x one without", took)
