"""Lanes: the memory of a holder, one growing array of rows a lane, and the state through which kernels find it.

The state and the first rows of all lanes lie in one allocation (the arena), so that a small holder costs little and thousands of them stay
small. A lane that grows moves to memory of its own; whoever still has a view keeps what it shows.

Lanes have one user at a time. Code that changes them, or runs a kernel on them, does so inside ``with lanes:``, which raises `InUse` where
another thread is inside. Code that only reads takes no lock: `Lanes.consistent` reads again where the lanes have changed meanwhile.
Compiled entries keep to the same rule by themselves (`backends/entry/*.ll`).
"""

from __future__ import annotations

from _thread import LockType, allocate_lock
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Self, TypeVar, assert_never, cast

import numpy as np

from rosetta_jit.errors import InUse, InvalidHolder, RosettaError
from rosetta_jit.kernel.state import (
    ADDRESS,
    CAPACITY,
    CLEAN,
    EPOCH,
    GROW,
    HIDDEN,
    HIDDEN_COUNT,
    RESULT,
    UNSETTLED,
    USED,
    VALID,
    WASTED,
    lane_word,
)
from rosetta_jit.model.initial_values import FirstCase, FixedArray, InitialValue
from rosetta_jit.model.layout import Layout
from rosetta_jit.runtime.attributes.code import functions, library
from rosetta_jit.runtime.cells import Array, Arrays, Cells, Memory
from rosetta_jit.runtime.first_memory import address_of_bytes, begun
from rosetta_jit.runtime.limits import MAX_READINGS
from rosetta_jit.runtime.locks import shared_lock
from rosetta_jit.runtime.memory import ALIGNMENT, Hidden, address_of, aligned, aligned_bytes
from rosetta_jit.runtime.memory_plan import Plan, plan

if TYPE_CHECKING:
    from numpy.typing import NDArray


_What = TypeVar("_What")
_Value = TypeVar("_Value")

MOST_AT_ONCE = 1 << 16
"""Bytes that a holder may have from the start because others needed them. It costs little to make room for more than that, compared with
filling it."""

MOST_UNASKED = 1 << 14
"""The same of a holder that is not made for a decoder."""

TOLERATED_WASTE = 1 << 16
"""Bytes that a holder may leave unused before it tidies up, at least."""

_ONE_AT_A_TIME = shared_lock()
"""Held where lanes make what is made when it is first asked for."""


class Lanes:
    """The memory of one holder or batch.

    Attributes
    ----------
    arena : bytearray
        The first memory, and some to spare.
    address : int
        Where the state lies, which kernels are given. It never moves.
    words : memoryview
        The words of the state; they are those of `rosetta_jit.kernel.state`.
    state : ndarray of int64
        The same words.
    memory : Memory
        The bytes of each lane, the scratch lane last.
    buffers : list of ndarray of uint8
        The same bytes.
    cells, arrays : Cells, Arrays
        The same bytes as scalars.
    hidden : Hidden or None
        What kernels have besides, from when one needed it.
    is_filled : bool
        Whether no decode is going on.
    lock : lock
        Held inside ``with lanes:``.
    registers : ndarray of int64
        Those of the program that runs kernels on them, where it has some.
    source : list
        One element: the message from which spans are borrowed, or None.
    rows : int
        How many messages they hold, from row 0 of lane 0 on.
    spares : list
        Where compiled code leaves the lanes for another holder, when theirs has ended.
    """

    __slots__ = (
        *("__weakref__", "address", "arena", "array_type", "arrays", "buffers", "cells", "hidden", "is_filled", "lock"),
        *("memory", "plan", "registers", "rows", "source", "spares", "state", "words"),
    )
    arena: bytearray
    arrays: Arrays
    buffers: list[NDArray[np.uint8]]
    cells: Cells
    hidden: Hidden | None
    lock: LockType
    memory: Memory
    registers: NDArray[np.int64]
    source: list[Any]
    state: NDArray[np.int64]
    words: memoryview

    def __init__(self, plan: Plan, array_type: type[Array] = np.ndarray) -> None:
        self.arena = arena = bytearray(plan.size_bytes + ALIGNMENT)
        self.plan = plan
        self.array_type = array_type
        self.address = begun(arena, plan.begin, plan.places)
        self.is_filled = True
        self.rows = plan.rows

    def prepared(self) -> Self:
        """The lanes, which nobody else has yet, with all that a batch is asked for when it is filled."""
        self.memory = memory = _memory(self)
        self.words = memory.first[: self.plan.state_bytes].cast("q")
        self.lock, self.source, self.hidden = allocate_lock(), [None], None
        return self

    if not TYPE_CHECKING:  # for which the slots are always there

        def __getattr__(self, name):
            """What not every holder is asked for is made when it first is: who has no such slot yet comes here."""
            made = _MADE.get(name)
            if made is None:
                raise AttributeError(f"lanes have no {name!r}")
            with _ONE_AT_A_TIME:
                try:
                    return object.__getattribute__(self, name)  # another thread was first
                except AttributeError:
                    value = made(self)
                    setattr(self, name, value)
                    return value

    def __enter__(self) -> Self:
        """Take the lanes. The lock makes this one step; the epoch tells compiled entries, one of which may itself be interrupted by us."""
        if not self.lock.acquire(False):
            raise in_use()
        words = self.words
        epoch = words[EPOCH]
        if epoch < 0:
            self.lock.release()
            raise in_use()
        words[EPOCH] = ~epoch
        return self

    def __exit__(self, *_: object) -> None:
        """Give the lanes back, with the next epoch: the negative of ``~epoch`` is ``epoch + 1``."""
        words = self.words
        words[EPOCH] = -words[EPOCH]
        self.is_filled = True
        self.lock.release()

    def consistent(self, read: Callable[[_What], _Value], what: _What) -> _Value:
        """What reading gives, all of it at one time: it is done again where the lanes have changed meanwhile.

        Raises
        ------
        InUse
            If they are in use, or change again and again.
        """
        words = self.words
        for _ in range(MAX_READINGS):
            epoch = words[EPOCH]
            if epoch < 0:
                break
            try:
                value = read(what)
            except (RosettaError, ValueError, LookupError):
                if words[EPOCH] == epoch:
                    raise
            else:
                if words[EPOCH] == epoch:
                    return value
        raise in_use()

    def epoch(self) -> int:
        """What tells, by `check_unchanged`, whether the lanes are as they were; another one after each change."""
        return self.words[EPOCH]

    def check_unchanged(self, epoch: int) -> None:
        """Inside ``with lanes:``, refuse to go on from what was read at an epoch if the lanes have changed since then: InUse."""
        if self.words[EPOCH] != ~epoch:
            raise in_use()

    @classmethod
    def of(cls, layout: Layout, rows: int = 1) -> Lanes:
        """Lanes of a layout."""
        return cls(plan(layout, rows))

    def used(self, lane: int) -> int:
        """How many rows of a lane are in use."""
        return self.words[lane_word(lane, USED)]

    def capacity(self, lane: int) -> int:
        """How many rows a lane has room for."""
        return self.words[lane_word(lane, CAPACITY)]

    def grow(self, lane: int, rows: int) -> None:
        """Room for so many rows more than the lane has, and at least twice as many as before; of a hidden lane, for so many bytes.

        Raises
        ------
        MemoryError
            If there is no such memory; the lanes are as before.
        """
        lanes = len(self.plan.strides)
        if lane >= lanes:
            self.hidden = self.hidden or Hidden()
            self.hidden.grow(lane - lanes, rows)
            self.words[HIDDEN], self.words[HIDDEN_COUNT] = self.hidden.address, len(self.hidden.buffers)
            return
        stride = self.plan.strides[lane]
        capacity = self.capacity(lane)
        capacity = max(2 * capacity, capacity + rows)
        old, buffer = self.memory[lane], aligned_bytes(aligned(capacity * stride, 8))
        memoryview(cast("Any", buffer))[: len(old)] = old
        self._place(lane, buffer, capacity)

    def _place(self, lane: int, buffer: NDArray[np.uint8], capacity: int) -> None:
        assert self.words[EPOCH] < 0, "a lane moves inside `with lanes:` alone, where no kernel but one's own runs"
        with _ONE_AT_A_TIME, suppress(AttributeError):
            self.memory[lane] = memoryview(cast("Any", buffer))
            del self.buffers  # made anew when somebody asks for them
        self.words[lane_word(lane, ADDRESS)] = address_of(buffer)
        self.words[lane_word(lane, CAPACITY)] = capacity
        self.cells, self.arrays = _MADE["cells"](self), _MADE["arrays"](self)

    def move(self, lane: int, buffer: NDArray[np.uint8], rows: int) -> None:
        """Other memory for a lane, with room for so many rows; nothing of the old one is copied."""
        self.give_back(lane, 0)
        self._place(lane, buffer, rows)

    def take(self, lane: int, rows: int) -> int:
        """Take so many rows at the lane's end into use, zeroed; the number of the first."""
        start = self.used(lane)
        missing = start + rows - self.capacity(lane)
        if missing > 0:
            self.grow(lane, missing)
        stride = self.plan.strides[lane]
        self.buffers[lane][start * stride : (start + rows) * stride] = 0
        self.words[lane_word(lane, USED)] = start + rows
        return start

    def initialise(self, initial: tuple[InitialValue, ...], start: int, rows: int) -> None:
        """Give rows, which are zero, their initial values."""
        for each in initial:
            match each:
                case FixedArray(row, word, lane, length, within):
                    first = self.take(lane, rows * length)
                    words = self.row_words(row, start, rows)
                    words[:, word] = np.arange(first, first + rows * length, length)
                    words[:, word + 1] = length
                    self.initialise(within, first, rows * length)
                case FirstCase(row, word, number):
                    self.row_words(row, start, rows)[:, word] = number
                case _:
                    assert_never(each)

    def row_words(self, lane: int, start: int, rows: int) -> NDArray[np.int64]:
        """The words of so many rows of a lane, a row each: shape (rows, words)."""
        stride = self.plan.strides[lane]
        return self.buffers[lane][start * stride : (start + rows) * stride].view(np.int64).reshape(rows, stride // 8)

    def give_back(self, lane: int, start: int) -> None:
        """Rows from ``start`` on are not in use any more."""
        self.words[lane_word(lane, USED)] = start

    def reset(self, rows: int = 1) -> None:
        """Empty messages in the first rows of lane 0, nothing in the others, and nothing borrowed."""
        if rows == 1 and self.plan.fresh and library() is not None:
            functions()["restart"](self.address, self.plan.fresh)
        else:
            self._reset_in_python(rows)
        self.rows = rows
        self.source[0] = None
        self.words[WASTED] = 0
        self.words[VALID] = CLEAN

    def restart(self) -> None:
        """The same of lanes of one message that nobody else has."""
        self.words[EPOCH] += 1
        self.reset()

    def _reset_in_python(self, rows: int) -> None:
        if rows > self.capacity(0):
            self.grow(0, rows - self.capacity(0))
        for lane in range(len(self.buffers)):
            self.give_back(lane, 0)
        self.take(0, rows)
        self.initialise(self.plan.initial, 0, rows)

    def copied(self) -> Lanes:
        """Lanes of their own with the same rows. Nothing may be borrowed."""
        made = Lanes(self.plan, self.array_type)
        with made:
            for lane, stride in enumerate(self.plan.strides):
                used = self.used(lane)
                if used > made.capacity(lane):
                    made.grow(lane, used - made.capacity(lane))
                made.memory[lane][: used * stride] = self.memory[lane][: used * stride]
                made.words[lane_word(lane, USED)] = used
            made.words[VALID], made.words[WASTED], made.rows = self.words[VALID], self.words[WASTED], self.rows
        return made

    def adopt(self, other: Lanes) -> None:
        """Take over the rows of other lanes of the same layout, which are not used any more."""
        for lane, buffer in enumerate(other.buffers):
            self._place(lane, buffer, other.capacity(lane))
            self.give_back(lane, other.used(lane))
        self.source[0] = None
        self.words[WASTED] = 0
        self.words[VALID] = CLEAN

    def begin_filling(self) -> None:
        """Inside ``with lanes:``, before a decode: there is nothing to be read until it has succeeded."""
        self.is_filled = False
        self.words[VALID] = self.words[RESULT] = 0

    def unsettle(self) -> None:
        """Encoders must not read this as it is."""
        self.words[VALID] = UNSETTLED

    def waste(self, lane: int, rows: int) -> None:
        """Rows of a lane are not referred to any more. Where there are many, the next encode tidies up."""
        self.words[WASTED] += rows * self.plan.strides[lane]
        if self.words[WASTED] > max(TOLERATED_WASTE, sum(buffer.size for buffer in self.buffers) // 2):
            self.unsettle()

    def borrowed(self, start: int, size: int) -> memoryview:
        """Bytes of the message that the holder borrows from, read-only."""
        return memoryview(self.source[0]).cast("B")[start : start + size].toreadonly()

    def invalid(self) -> RosettaError:
        """The error of reading what was not filled a moment ago: a decode had failed, or was not done, or about to make room for itself."""
        words = self.words
        epoch = words[EPOCH]
        has_failed = self.is_filled and words[RESULT] != GROW and not words[VALID]
        if not has_failed or words[EPOCH] != epoch:
            return in_use()
        return InvalidHolder("the last decode into this holder failed; decode again or clear it before you read it")


def in_use() -> InUse:
    """The error of using what somebody else uses."""
    return InUse(
        "this holder or batch is in use: another thread is filling, changing or encoding it (or this one was interrupted while it did). "
        "Give each thread a holder of its own, from `decoder.new()`, or a decoder of its own"
    )


def _memory(lanes: Lanes) -> Memory:
    """The first memory, from where it is aligned."""
    whole = memoryview(lanes.arena)
    shift = lanes.address - address_of_bytes(lanes.arena)
    return Memory(whole[shift : shift + lanes.plan.size_bytes], lanes.plan.offsets, lanes.plan.sizes)


_MADE: dict[str, Callable[[Lanes], Any]] = {
    "memory": _memory,
    "words": lambda lanes: lanes.memory.first[: lanes.plan.state_bytes].cast("q"),
    "hidden": lambda _: None,
    "lock": lambda _: allocate_lock(),
    "source": lambda _: [None],
    "state": lambda lanes: np.frombuffer(lanes.words, np.int64),
    "buffers": lambda lanes: [np.frombuffer(lanes.memory[lane], np.uint8) for lane in range(len(lanes.plan.strides))],
    "cells": lambda lanes: Cells(lanes.memory),
    "arrays": lambda lanes: Arrays(lanes.memory, lanes.plan.dtypes, lanes.array_type),
}
