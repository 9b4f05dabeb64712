"""Rows of words to columns by compiled code, without the interpreter lock: numpy takes twice the time, and keeps the lock."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.errors import warn
from rosetta_jit.runtime.cache.texts import kept, known
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.allowed import ForeignCodeError
from rosetta_jit.runtime.memory import address_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Indices = NDArray[np.int64]

LEAST = 4096
"""Rows below which it takes longer to load the code than numpy does."""

WORTH_COMPILING = 1 << 17
"""Rows for which the code is compiled where the cache has it not: that takes as long as numpy takes for some hundred thousand."""

_TRANSPOSE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p)
"""Of rows, of the bytes from one to the next, of how many rows and words there are; of the places of the columns."""


def transposed(rows: Indices, room: Callable[[int], Indices]) -> list[Indices] | None:
    """The columns of many rows, each in ``room`` of its own, so that it goes when it is used no more; None where numpy is to make them.

    Parameters
    ----------
    rows : ndarray of int64, shape (n, words)
        The words of a row lie together.
    """
    count, words = rows.shape
    prepare(count)
    transpose = _transpose() if count >= LEAST and rows.flags.writeable and _is_there() else None
    if transpose is None:
        return None
    columns = [room(count) for _ in range(words)]
    places = np.array([address_of(each) for each in columns], np.int64)
    begin = ctypes.addressof(ctypes.c_char.from_buffer(rows[0].data))
    transpose(begin, rows.strides[0], count, words, address_of(places))
    return columns


def prepare(rows: int) -> None:
    """Before tables of so many rows together: compile the code, if that is worth while and the cache has it not."""
    if rows >= WORTH_COMPILING:
        _transpose()


def _is_there() -> bool:
    """Whether the code is loaded, or can be without a compiler."""
    return _transpose.cache_info().currsize > 0 or known(_text()) is not None


@cache
def _transpose() -> Callable[[int, int, int, int, int], None] | None:
    """The code; None where memory cannot be executed."""
    library = _library()
    return None if library is None else _TRANSPOSE(library["transpose"])


@cache
def _library() -> native.Library | None:
    def compiled() -> bytes:
        from rosetta_jit.runtime.code.assembler import assembled  # imports LLVM

        return assembled(_text(), ("transpose",))

    try:
        return native.load(kept("rows as columns", _text(), compiled), ("transpose",))
    except ForeignCodeError as error:
        warn(f"rows become columns without compiled code, which takes longer: {error}", RuntimeWarning)
        return None


@cache
def _text() -> str:
    return Path(__file__).with_name("transpose.ll").read_text("utf-8")
