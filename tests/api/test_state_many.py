"""Many messages of a mapping that keeps state, in the loop that is compiled for them: the same as one by one, whatever the messages are."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.api.programs import build_of
from rosetta_jit.backends.entry.program import Program

FILES = {
    "lab/msg/Joint.msg": "float64 position\nint64 seq\nstring name\n",
    "lab/msg/Motion.msg": "float64 speed\nfloat64 smooth\nint64 seen\nstring name\n",
    "m.mapping": """import "lab/msg/Joint.msg"
import "lab/msg/Motion.msg"
data-holder: lab/msg/Motion
wire-schema: lab/msg/Joint
state last: float64 = 0.5
state smooth: float64 = 0.0
state seen: int64 = 0
unpack-rules:
  reject "seen before" when .seq < 0
  .speed = .position - last
  .smooth = smooth + 0.25 * (.position - smooth)
  .seen = seen
  .name = .name
  state last = .position
  state smooth = smooth + 0.25 * (.position - smooth)
  state seen = seen + 1
""",
}


@pytest.fixture(scope="module")
def made():
    decode = rj.Decoder("m.mapping", schema=FILES, encoding="cdr")
    assert Program(build_of(decode._request).kernels, "decode", {"with_numba": False}).has_own_many
    writers = [
        rj.Encoder.of("lab/msg/Joint", schema=FILES, imports=["lab/msg/Joint.msg"], encoding="cdr", byte_order=order)
        for order in ("little", "big")
    ]
    random = np.random.default_rng(0)

    def message(seq):
        write = writers[int(random.integers(0, 8)) // 7]
        plain = {"position": random.normal(), "seq": seq, "name": "x" * int(random.integers(0, 40))}
        return write(write.holder_type.from_dict(plain))

    return decode, [message(seq) for seq in range(300)], message(-1)


def one_by_one(decode, messages):
    """What the program makes of messages, None of those that it refuses, and what it keeps in the end."""
    decode.reset()
    found = []
    for each in messages:
        try:
            found.append(decode(each).to_dict())
        except rj.DecodeError:
            found.append(None)
    return found, dict(decode.state)


def test_the_same_as_one_by_one(made):
    """Byte orders in turn; the lane of names is too small at first."""
    decode, messages, _ = made
    expected, state = one_by_one(decode, messages)
    decode.reset()
    assert [row.to_dict() for row in decode.many(messages)] == expected
    assert decode.state == state
    batch = decode.many(messages[:100])
    assert batch.seen.tolist() == list(range(300, 400))
    decode.reset()
    again = decode.many(messages, into=batch)
    assert [row.to_dict() for row in again] == expected


@pytest.mark.parametrize("on_error", ["skip", "mask"])
def test_messages_that_are_broken_leave_no_trace(made, on_error):
    decode, messages, refused = made
    mixed = list(messages[:60])
    mixed[0] = mixed[7] = refused
    mixed[8] = messages[8][:-1]
    mixed[30] = b""
    mixed[59] = messages[59] + bytes(9)
    expected, state = one_by_one(decode, mixed)
    assert [number for number, each in enumerate(expected) if each is None] == [0, 7, 8, 30, 59]
    decode.reset()
    batch = decode.many(mixed, on_error=on_error)
    assert sorted(batch.errors) == [0, 7, 8, 30, 59]
    assert decode.state == state
    rows = [row.to_dict() for row in batch]
    assert [each for each in rows if on_error == "skip" or each["seen"] or each["name"]] == [
        each for each in expected if each and (on_error == "skip" or each["seen"] or each["name"])
    ]


def test_an_error_keeps_what_came_before(made):
    decode, messages, refused = made
    decode.reset()
    with pytest.raises(rj.DecodeError, match=r"seen before.*\[5\]"):
        decode.many([*messages[:5], refused, *messages[5:]])
    assert decode.state == one_by_one(decode, messages[:5])[1]
    decode.reset()
    data, offsets = b"".join(messages[:8]), np.cumsum([0, *map(len, messages[:8])])
    offsets[5] = 0
    with pytest.raises(ValueError, match="fall"):
        decode.many(data, offsets)
    assert decode.state["seen"] == 4
    assert len(decode.many(data, np.zeros(1, np.int64))) == 0
    assert decode.state["seen"] == 4
    constant = np.cumsum([0, *map(len, messages[:8])])
    constant.flags.writeable = False
    assert decode.many(data, constant).seen.tolist() == list(range(4, 12))
