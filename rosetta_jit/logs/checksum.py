"""CRC-32 as zlib has it, several times as fast where the CPU can multiply without carries: chunks of logs are as large as what is read."""

from __future__ import annotations

import ctypes
import zlib
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from rosetta_jit.logs.walking import library_of
from rosetta_jit.runtime.code.processor import multiplies_without_carries

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.runtime.code.native import Library

LEAST = 4096
"""Bytes below which zlib takes no longer."""

BLOCK = 64
ALL_ONES = 0xFFFFFFFF
CONSTANTS = np.array([ALL_ONES, 0, 0x154442BD4, 0x1C6E41596, 0x1751997D0, 0x0CCAA009E], np.uint64)
"""The first value of the checksum's register, and what moves a sum by 64 and by 16 bytes: x to powers, reflected, modulo the polynomial."""

_FOLD = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)


def crc32(data: NDArray[np.uint8]) -> int:
    """The checksum of bytes that lie together."""
    fold = _fold() if data.size >= LEAST else None
    if fold is None:
        return zlib.crc32(data.data)
    assert data.flags.c_contiguous
    blocks, rest = data.size // BLOCK, np.empty(16, np.uint8)
    fold(data.ctypes.data, blocks, CONSTANTS.ctypes.data, rest.ctypes.data)
    return zlib.crc32(data[blocks * BLOCK :].data, zlib.crc32(rest.data, ALL_ONES))  # zlib's register is empty when it is given ones


@cache
def _fold() -> Any:
    """The compiled function, which runs without the interpreter lock; None on CPUs that cannot run it."""
    if not multiplies_without_carries():
        return None
    return _FOLD(_library()["fold"])


@cache
def _library() -> Library:
    """The code, which lives as long as the process."""
    return library_of("fold.ll", ("fold",))
