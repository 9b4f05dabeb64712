"""State of bridges, which have that of a decoder and that of an encoder."""

from __future__ import annotations

from itertools import pairwise

import pytest

import rosetta_jit as rj
from tests.api.test_state import BACKENDS, HEAD, READ, SCHEMAS, message

BRIDGED = {
    **SCHEMAS,
    "in.mapping": f"""{HEAD}
state seen: int64 = 0
unpack-rules:
  ignore .position
  ignore .good
  .speed = 0.0
  .low = 0.0
  .seen = .seq + seen
  .gap = false
  .note = "n"
  state seen = seen + 1
""",
    "out.mapping": f"""{HEAD}
state seen: int64 = -1
pack-rules:
  ignore .speed
  ignore .low
  ignore .gap
  ignore .note
  reject "no" when .seen == 13
  .position = float64(seen)
  .seq = .seen
  .good = true
  state seen = .seen
""",
}


def bridge(backend):
    options = {"schema": BRIDGED, "encoding": "yarp4", "backend": backend}
    return rj.Bridge("in.mapping", "out.mapping", decode=options, encode=options)


@pytest.mark.parametrize("backend", BACKENDS)
def test_bridges(backend):
    """Both halves have state, and a message that the second one refuses changes that of neither."""
    over = bridge(backend)
    found = []
    for seq in (1, 2, 11, 3):  # the third one becomes 13
        try:
            values = READ(over(message(seq=seq)))
            found.append((values.position, values.seq))
        except rj.EncodeError as error:
            found.append(error.kind)
    assert found == [(-1.0, 1), (1.0, 3), "rejected", (3.0, 5)]
    assert over.state == {"decode": {"seen": 3}, "encode": {"seen": 5}}
    over.reset()
    assert over.state == {"decode": {"seen": 0}, "encode": {"seen": -1}}
    buffer, offsets = over.many([message(seq=seq) for seq in (1, 2, 3)])
    assert [READ(bytes(buffer[a:b])).seq for a, b in pairwise(offsets)] == [1, 3, 5]
    with pytest.raises(rj.EncodeError, match=r"\[1\]"):
        over.many([message(seq=1), message(seq=9)])
    assert READ(over(message(seq=0))).to_dict() == {"position": 4.0, "seq": 4, "good": True}
    room = bytearray(10)
    with pytest.raises(BufferError):
        over.into(message(), room)
    assert READ(over(message(seq=0))).to_dict() == {"position": 4.0, "seq": 5, "good": True}
