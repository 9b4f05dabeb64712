"""Memory of ours: where it lies, and that it lies well."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, cast

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

ALIGNMENT = 64
"""Of each lane: a cache line, and the widest vector register."""

MOST_BYTES = 1 << 62
"""More than any address space has."""


def aligned(size: int, alignment: int = ALIGNMENT) -> int:
    """The next multiple."""
    return -(-size // alignment) * alignment


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
