"""Hidden lanes: memory that kernels have besides a holder's fields, for what they compute on the way. Made when a kernel first needs it."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from rosetta_jit.kernel.state import ADDRESS, CAPACITY, LANE_WORDS

if TYPE_CHECKING:
    from numpy.typing import NDArray

ALIGNMENT = 64
"""Of each lane: a cache line, and the widest vector register."""

INITIAL_BYTES = 256
"""What a hidden lane has room for before it grows."""


MOST_BYTES = 1 << 62
"""More than any address space has."""


def address_of(memory: NDArray[Any]) -> int:
    """Where an array of ours lies, which has elements and can be written: numpy takes six times as long to say it."""
    return ctypes.addressof(ctypes.c_char.from_buffer(cast("Any", memory)))


def aligned_bytes(size: int) -> NDArray[np.uint8]:
    """Bytes that begin at a multiple of `ALIGNMENT`.

    Raises
    ------
    MemoryError
        If there is no such memory.
    """
    if size > MOST_BYTES:  # numpy says this in other words
        raise MemoryError(f"no memory has {size} bytes")
    memory = np.empty(size + ALIGNMENT, np.uint8)
    shift = -address_of(memory) % ALIGNMENT
    return memory[shift : shift + size]


class Hidden:
    """The hidden lanes of one holder or batch. What is in them is nobody's between two messages, so any kernel may use any of them.

    Attributes
    ----------
    buffers : list of ndarray of uint8
        The bytes of each lane.
    """

    __slots__ = ("_words", "buffers")

    def __init__(self) -> None:
        self.buffers: list[NDArray[np.uint8]] = []
        self._words = np.zeros(0, np.int64)

    @property
    def address(self) -> int:
        """Where the words of the lanes lie, as `rosetta_jit.kernel.state` has them."""
        return self._words.__array_interface__["data"][0]

    def grow(self, lane: int, size: int) -> None:
        """As many lanes as this one needs to be there, and in it so many bytes more, at least twice as many as before."""
        while len(self.buffers) <= lane:
            self.buffers.append(aligned_bytes(INITIAL_BYTES))
        if size > 0:
            old = self.buffers[lane].size
            self.buffers[lane] = aligned_bytes(-(-max(2 * old, old + size) // ALIGNMENT) * ALIGNMENT)
        self._words = np.zeros(LANE_WORDS * len(self.buffers), np.int64)
        self._words[ADDRESS::LANE_WORDS] = [address_of(buffer) for buffer in self.buffers]
        self._words[CAPACITY::LANE_WORDS] = [buffer.size for buffer in self.buffers]
