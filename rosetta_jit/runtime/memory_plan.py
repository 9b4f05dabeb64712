"""Plans: how the first memory of a holder is divided among its lanes, and what the state says of them."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

import numpy as np

from rosetta_jit.kernel.state import ADDRESS, CLEAN, STRIDE, USED, VALID, lane_word, state_words
from rosetta_jit.model.initial_values import FixedArray, InitialValue
from rosetta_jit.model.layout import Layout, Number
from rosetta_jit.runtime.cells import BYTES, dtype_of
from rosetta_jit.runtime.memory import aligned
from rosetta_jit.startup.dataclass import dataclass, replace

INITIAL_BYTES = 64
"""What a lane has room for before it grows."""

SCRATCH_STRIDE = 8
"""One word a row, for what an encoder must remember between its passes."""


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """How the arena of a layout is divided: a function of the layout and the first capacities, made once a class.

    ``begin`` is how it begins, up to the last byte that is not zero: the state, of ``state_bytes``, without its addresses, and what the
    messages begin with. ``places`` has pairs of int64: a word of the state, and the offset
    of the lane whose address stands there. ``fresh`` is what each lane has of a new message: its words in the state, counted in bytes, how
    many rows, how many bytes, and these.
    """

    layout: Layout
    rows: int
    strides: tuple[int, ...]
    offsets: tuple[int, ...]
    sizes: tuple[int, ...]
    dtypes: tuple[np.dtype[Any], ...]
    size_bytes: int
    state_bytes: int
    begin: bytes
    places: bytes
    initial: tuple[InitialValue, ...] = ()
    fresh: bytes = b""


def plan(layout: Layout, rows: int = 1, initial: tuple[InitialValue, ...] = (), room: Sequence[int] = ()) -> Plan:
    """A plan with room for so many messages, which are in use from the start, and zero; and for the initial values of one of them.

    Where ``room`` says how many rows a lane is to have, it has at least as many.
    """
    needed: dict[int, int] = {}
    _count(initial, 1, needed)
    strides = (*(lane.stride for lane in layout.lanes), SCRATCH_STRIDE)
    state = np.zeros(state_words(len(strides)), np.int64)
    state[VALID] = CLEAN
    behind = aligned(state.nbytes)
    offsets: list[int] = []
    sizes: list[int] = []
    for lane, stride in enumerate(strides):
        capacity = max(rows, 1) if lane == 0 else max(1, INITIAL_BYTES // stride, needed.get(lane, 0))
        capacity = max(capacity, room[lane] if room else 0)
        offsets.append(behind)
        sizes.append(aligned(capacity * stride, 8))
        state[lane_word(lane, ADDRESS) : lane_word(lane, STRIDE) + 1] = 0, capacity, rows if lane == 0 else 0, stride
        behind = aligned(behind + sizes[-1])
    places = b"".join(struct.pack("=2q", lane_word(lane, ADDRESS), offset) for lane, offset in enumerate(offsets))
    dtypes = (*(dtype_of(lane.element.scalar) if isinstance(lane.element, Number) else BYTES for lane in layout.lanes), BYTES)
    made = Plan(layout, rows, strides, tuple(offsets), tuple(sizes), dtypes, behind, state.nbytes, state.tobytes(), places, initial)
    return begun(made, made.begin) if rows == 1 else made


def begun(plan: Plan, begin: bytes) -> Plan:
    """The plan, with another beginning of its memory."""
    state, fresh = np.frombuffer(begin[: plan.state_bytes], np.int64), b""
    for lane, (stride, offset) in enumerate(zip(plan.strides, plan.offsets, strict=True)):
        used = int(state[lane_word(lane, USED)])
        size = aligned(used * stride, 8)
        fresh += struct.pack("=3q", 8 * lane_word(lane, ADDRESS), used, size) + begin[offset : offset + size].ljust(size, b"\0")
    return replace(plan, begin=begin, fresh=fresh)


def _count(initial: tuple[InitialValue, ...], rows: int, taken: dict[int, int]) -> None:
    """Add up how many rows of each lane the initial values of so many rows take."""
    for each in initial:
        if isinstance(each, FixedArray):
            taken[each.lane] = taken.get(each.lane, 0) + rows * each.length
            _count(each.within, rows * each.length, taken)
