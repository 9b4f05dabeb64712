"""Memory for lanes at well aligned addresses, and the hidden lanes that kernels use besides a holder's fields."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

from rosetta_jit.kernel.state import ADDRESS, CAPACITY, LANE_WORDS

if TYPE_CHECKING:
    from numpy.typing import NDArray


ALIGNMENT = 64
"""Of each lane: a cache line, and the widest vector register."""

PAGE, MANY = 1 << 12, 1 << 14
"""Large messages mostly lie 16 to 64 bytes behind the begin of a page, and what is copied from them a header further. To copy it to 1 to 15
bytes behind the same place of a page takes ten times as long (docs/performance.md, "Where bytes lie"): its begin is far from there."""

LARGE = 1 << 22
"""Bytes from which on memory of its own is better than a part of another: numpy asks Linux for pages of 2 MB for so large an array, which
are filled a tenth sooner (docs/performance.md, "Columns larger than the caches")."""

MOST_BYTES = 1 << 62
"""More than any address space has."""


def aligned(size: int, alignment: int = ALIGNMENT) -> int:
    """The next multiple."""
    return -(-size // alignment) * alignment


def address_of(memory: NDArray[Any]) -> int:
    """Where an array of ours lies, which has elements and can be written: numpy takes six times as long to say it."""
    writable: Any = memory
    return ctypes.addressof(ctypes.c_char.from_buffer(writable))


def pointer_to(memory: NDArray[np.uint8]) -> int | bytes:
    """Where bytes lie, as ctypes takes it for a ``c_void_p``: it takes a bytes object itself, much sooner than numpy says an address."""
    base: Any = memory.base
    if type(base) is memoryview and type(base.obj) is bytes and len(base.obj) == memory.size:
        return base.obj
    return address_of(memory) if memory.size and memory.flags.writeable else memory.ctypes.data


def has_references(view: memoryview) -> bool:
    """Whether there are references to Python's objects among what a buffer has, by its format; between colons stand names of fields."""
    return view.itemsize != 1 and any("O" in part for part in view.format.split(":")[::2])


def no_message(value: object) -> BufferError:
    """The error of reading references to objects as a message: their bytes are addresses."""
    return BufferError(f"{type(value).__name__} has references to Python objects, and no bytes of a message: give bytes, or numbers")


def aligned_bytes(size: int) -> NDArray[np.uint8]:
    """Bytes that begin at a multiple of `ALIGNMENT`, or of a page, if they are many.

    Raises
    ------
    MemoryError
        If there is no such memory.
    """
    if size > MOST_BYTES:  # numpy says this in other words
        raise MemoryError(f"no memory has {size} bytes")
    alignment = PAGE if size >= MANY else ALIGNMENT
    memory = np.empty(size + alignment, np.uint8)
    shift = -address_of(memory) % alignment
    return memory[shift : shift + size]


INITIAL_BYTES = 256
"""What a hidden lane has room for before it grows."""


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
            self.buffers[lane] = aligned_bytes(aligned(max(2 * old, old + size)))
        self._words = np.zeros(LANE_WORDS * len(self.buffers), np.int64)
        self._words[ADDRESS::LANE_WORDS] = [address_of(buffer) for buffer in self.buffers]
        self._words[CAPACITY::LANE_WORDS] = [buffer.size for buffer in self.buffers]
