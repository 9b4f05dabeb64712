"""Walks over the records of a log in compiled code: a stretch of bytes becomes a row a message, in one call without the interpreter lock.

A walk stops at the end, where its room is full, or at a record that it does not know: a definition, a chunk, damage. The reader deals with
that record and walks on behind it.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Collection
from enum import IntEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from rosetta_jit.runtime.cache.texts import kept
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.native import Library
from rosetta_jit.runtime.memory import address_of, pointer_to
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray


WALKS = ("mcap", "lcm", "bag")
ROOM = 65_536
"""Messages a walk finds in one call."""

FEW = 4
"""Channels that are compared one by one, each in a tenth of the time that `numpy.isin` takes."""

_WALK = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)


class Why(IntEnum):
    """Why a walk stopped."""

    END = 0
    ROOM = 1
    CUT = 2
    OTHER = 3
    BROKEN = 4


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """The messages in a stretch of bytes, in the order in which they lie there.

    Attributes
    ----------
    channels, log_ns, publish_ns, begins, ends : ndarray of int64, shape (n,)
        Of each message: the number of its channel, its times since 1970, and where it lies.
    """

    channels: NDArray[np.int64]
    log_ns: NDArray[np.int64]
    publish_ns: NDArray[np.int64]
    begins: NDArray[np.int64]
    ends: NDArray[np.int64]

    @classmethod
    def of(cls, numbers: NDArray[np.int64]) -> Rows:
        """From an array of shape (5, n)."""
        return cls(numbers[0], numbers[1], numbers[2], numbers[3], numbers[4])

    def __len__(self) -> int:
        return len(self.channels)

    def only(self, chosen: NDArray[Any] | slice) -> Rows:
        """Some of them, by a mask or by numbers."""
        return Rows(self.channels[chosen], self.log_ns[chosen], self.publish_ns[chosen], self.begins[chosen], self.ends[chosen])

    def are_of(self, channels: Collection[int]) -> NDArray[np.bool_]:
        """Which of them are of some channels: shape (n,)."""
        if len(channels) > FEW:
            return np.isin(self.channels, list(channels))
        first, *others = channels or (-1,)
        found = self.channels == first
        for number in others:
            found |= self.channels == number
        return found

    def of_channels(self, channels: Collection[int]) -> Rows:
        """Those of some channels; the same rows, if all are."""
        found = self.are_of(channels)
        return self if found.all() else self.only(found)


@dataclass(frozen=True, slots=True)
class Stop:
    """Where a walk stopped, why, and the size that the record there says it has, if it was reached."""

    at: int
    why: Why
    size: int


def walk(
    records: Literal["mcap", "lcm", "bag"],
    data: NDArray[np.uint8],
    at: int,
    *,
    seed: int = 0,
    memory: Callable[[int], NDArray[np.int64]] | None = None,
) -> tuple[Rows, Stop]:
    """The messages from a place on. ``memory`` gives memory for so many numbers, in which the rows then are; else they have their own."""
    assert 0 <= at <= data.size
    state = np.array([at, 0, 0, seed], np.uint64)
    room = min(ROOM, (data.size - at) // _LEAST[records] + 1)
    rows = (memory or _of_thread)(5 * room)[: 5 * room].reshape(5, room)
    count = _function(records)(pointer_to(data), data.size, address_of(state), address_of(rows), room)
    at, why, size = map(int, state[:3].tolist())
    found = rows[:, :count]
    return Rows.of(found.copy() if memory is None else found), Stop(at, Why(why), size)


_SCRATCH = threading.local()
"""Of each thread the memory that walks write to. Fresh memory for as many messages as there could be would take as long as the walk."""


def _of_thread(size: int) -> NDArray[np.int64]:
    """Room for so many numbers: what was there before is gone."""
    memory: NDArray[np.int64] | None = getattr(_SCRATCH, "memory", None)
    if memory is None or memory.size < size:
        memory = _SCRATCH.memory = np.empty(size, np.int64)
    return memory


_LEAST = {"mcap": 31, "lcm": 28, "bag": 8}
"""Bytes that a message takes at least."""


@cache
def _function(name: str) -> Any:
    return _WALK(_library()[name])


@cache
def _library() -> Library:
    return library_of("walk.ll", WALKS)


def library_of(file: str, symbols: tuple[str, ...]) -> Library:
    """The code of a file beside this one in LLVM's language, from the kernel cache or compiled."""
    text = Path(__file__).with_name(file).read_text("utf-8")

    def compiled() -> bytes:
        from rosetta_jit.runtime.code.assembler import assembled  # imports LLVM

        return assembled(text, symbols)

    return native.load(kept("walks", text, compiled), symbols)
