"""CRC-32 as zlib has it, several times as fast where the CPU can multiply without carries: chunks of logs are as large as what is read."""

from __future__ import annotations

import ctypes
import zlib
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.logs.reading.walking import library_of
from rosetta_jit.runtime.code.native import Library
from rosetta_jit.runtime.code.processor import carryless_bits
from rosetta_jit.runtime.memory import address_of, pointer_to
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray


LEAST = 4096
"""Bytes below which zlib takes no longer."""

ALL_ONES = 0xFFFFFFFF
CONSTANTS = np.array([ALL_ONES, 0, 0x154442BD4, 0x1C6E41596, 0x1751997D0, 0x0CCAA009E, 0x11542778A, 0x1322D1430], np.uint64)
"""The first value of the checksum's register, and what moves a sum by 64, by 16 and by 256 bytes: of each distance of n bits, x to the
powers of n + 32 and n - 32, reflected, modulo the polynomial."""

_FOLD = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)


@dataclass(frozen=True, slots=True)
class Fold:
    """A compiled function, which runs without the interpreter lock, and the bytes that it takes at a time."""

    block: int
    run: Callable[[int | bytes, int, int, int], None]


def crc32(data: NDArray[np.uint8]) -> int:
    """The checksum of bytes that lie together."""
    fold = _fold() if data.size >= LEAST else None
    if fold is None or data.size < fold.block:
        return zlib.crc32(data.data)
    assert data.flags.c_contiguous
    blocks, rest = data.size // fold.block, np.empty(16, np.uint8)
    fold.run(pointer_to(data), blocks, address_of(CONSTANTS), address_of(rest))
    return zlib.crc32(data[blocks * fold.block :].data, zlib.crc32(rest.data, ALL_ONES))  # zlib's register is empty when it is given ones


@cache
def _fold() -> Fold | None:
    """The fastest that the CPU can run; None where it can run none."""
    match carryless_bits():
        case 512:
            return _compiled("fold_wide.ll", 256)
        case 128:
            return _compiled("fold.ll", 64)
        case _:
            return None


@cache
def _compiled(file: str, block: int) -> Fold:
    """The code, which lives as long as the process."""
    library = _library(file)
    return Fold(block, _FOLD(library["fold"]))


@cache
def _library(file: str) -> Library:
    return library_of(file, ("fold",))
