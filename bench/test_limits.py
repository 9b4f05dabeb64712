"""What nobody gets below: a call from Python, a call into compiled code, moving bytes, a process that imports what it needs."""

from __future__ import annotations

import weakref

import numpy as np

from bench.contest import Contender
from bench.messages import specialised
from bench.peers.native import rounds_of
from bench.peers.yarp_native import Peers, empty_builtin

SIZES = (200, 9_000, 1 << 20)


def test_calls(effort, compare):
    message, empty, array = specialised(24), empty_builtin(), np.frombuffer(specialised(24), np.uint8)
    target = np.empty_like(array)
    alive = weakref.ref(array)
    assert empty(message) is message
    assert alive() is array
    compare(
        "Limits",
        "a call",
        [
            Contender("len()", "limit", "a number", effort.call(len, message)),
            Contender("an empty builtin of one argument", "limit", "its argument", effort.call(empty, message)),
            Contender("a weak reference", "limit", "an object; the least that an object which is no function does", effort.call(alive)),
            Contender("an empty function in Python", "limit", "None", effort.call(nothing, message)),
            Contender("a numpy copy of 200 bytes", "limit", "an array, used again", effort.call(np.copyto, target, array)),
        ],
    )


def test_moves(effort, compare):
    peers = Peers()
    copies = [(np.empty(size, np.uint8), np.zeros(size, np.uint8)) for size in SIZES]
    compare(
        "Limits",
        "bytes moved",
        [
            *(
                Contender(f"a numpy copy of {size:,} bytes", "limit", "an array, used again", effort.call(np.copyto, *copy))
                for size, copy in zip(SIZES, copies, strict=True)
            ),
            *(
                Contender(
                    f"memmove of {size:,} bytes in C++", "limit", "a buffer, used again", rounds_of(peers.memmove(size), effort.round_s)
                )
                for size in SIZES
            ),
        ],
    )


def nothing(_message):
    return None
