"""Messages of several wires in one holder: each fills its part, and what other messages have filled stays.

A message that is refused leaves its part half filled. The holder is not valid then, until a message of the same wire fills that part anew;
messages of other wires are decoded meanwhile. The compiled entry takes messages for valid holders alone, so that this is known here.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from weakref import WeakKeyDictionary

from rosetta_jit.kernel.state import CLEAN, VALID
from rosetta_jit.runtime.holder import Holder
from rosetta_jit.runtime.holder.classes import settle_lanes
from rosetta_jit.runtime.lanes import Lanes

NOT_WHOLE = "a message of one of several wires fills a part of a holder: decode it by a call, or by `into`, and not {}"


@contextmanager
def joining(holder: Holder, wire: int, broken: set[int], *, has_failed: bool) -> Generator[None]:
    """Around the decoding of one message, inside ``with holder.lanes_:``.

    Parameters
    ----------
    wire
        The number of its wire.
    broken
        The wires whose last message for this holder was refused; it is brought up to date.
    has_failed
        Whether the kernel has just tried, and changed its part.
    """
    lanes = holder.lanes_
    if lanes.words[VALID] or has_failed:
        broken.clear()  # those of what the holder held before it was emptied, or copied over
    if has_failed:
        broken.add(wire)
    elif lanes.words[VALID]:
        settle_lanes(holder)
    elif not broken:
        lanes.reset()  # another program has left it half filled
    lanes.begin_filling()
    broken.add(wire)
    yield
    broken.discard(wire)
    lanes.words[VALID] = 0 if broken else CLEAN


def broken_wires(holders: WeakKeyDictionary[Lanes, set[int]], holder: Holder) -> set[int]:
    """The wires whose last message for a holder was refused, of all ``holders`` that some programs fill."""
    lanes = holder.lanes_
    found = holders.get(lanes)
    if found is None:
        found = holders[lanes] = set()
    return found
