"""Memory of ours: where it lies, and that it lies well."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, cast

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

ALIGNMENT = 64
"""Of each lane: a cache line, and the widest vector register."""

PAGE, MANY = 1 << 12, 1 << 14
"""Large messages mostly lie 16 to 64 bytes behind the begin of a page, and what is copied from them a header further. To copy it to 1 to 15
bytes behind the same place of a page takes ten times as long (docs/performance.md, "Where bytes lie"): its begin is far from there."""

MOST_BYTES = 1 << 62
"""More than any address space has."""


def aligned(size: int, alignment: int = ALIGNMENT) -> int:
    """The next multiple."""
    return -(-size // alignment) * alignment


def address_of(memory: NDArray[Any]) -> int:
    """Where an array of ours lies, which has elements and can be written: numpy takes six times as long to say it."""
    return ctypes.addressof(ctypes.c_char.from_buffer(cast("Any", memory)))


def pointer_to(memory: NDArray[np.uint8]) -> int | bytes:
    """Where bytes lie, as ctypes takes it for a ``c_void_p``: it takes a bytes object itself, much sooner than numpy says an address."""
    base = cast("Any", memory.base)
    if type(base) is memoryview and type(base.obj) is bytes and len(base.obj) == memory.size:
        return base.obj
    return memory.ctypes.data


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
