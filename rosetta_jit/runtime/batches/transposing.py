"""Rows of words to columns by compiled code, without the interpreter lock: numpy takes twice the time, and keeps the lock."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.errors import warn
from rosetta_jit.runtime.cache.texts import kept, known
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.allowed import ForeignCodeError
from rosetta_jit.runtime.memory import address_of
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Indices = NDArray[np.int64]

LEAST = 4096
"""Rows below which it takes longer to load the code than numpy does."""

WORTH_COMPILING = 1 << 17
"""Rows for which the code is compiled where the cache has it not: that takes as long as numpy takes for some hundred thousand."""

_ROWS, _COLUMNS, _STEADY = [ctypes.c_void_p, *[ctypes.c_int64] * 3], [ctypes.c_void_p], [ctypes.c_int64, ctypes.c_void_p]
_TRANSPOSE = ctypes.CFUNCTYPE(None, *_ROWS, *_COLUMNS, *_STEADY)
"""Of rows, of the bytes from one to the next, of how many rows and words there are; of the places of the columns; of steady words, which
``transpose.ll`` describes, how many there are, and where they lie."""


@dataclass(frozen=True, slots=True)
class Steady:
    """A column of so many values, each by ``step`` greater than the one before."""

    first: int
    step: int
    count: int

    def values(self) -> Indices:
        """All of them."""
        return self.first + self.step * np.arange(self.count)


def transposed(rows: Indices, room: Callable[[int], Indices], steps: Iterable[tuple[int, int]] = ()) -> list[Indices | Steady] | None:
    """The columns of many rows, each in ``room`` of its own, so that it goes when it is used no more; None where numpy is to make them.

    Parameters
    ----------
    rows : ndarray of int64, shape (n, words)
        The words of a row lie together.
    steps
        Words, each with how much it is likely to grow by from row to row. Where that is so, nothing is written for it.
    """
    count, words = rows.shape
    prepare(count)
    if count < LEAST or not rows.flags.writeable or not _is_there() or (transpose := _transpose()) is None:
        return None
    likely = {word: Steady(int(rows[0, word]), step, count) for word, step in steps}
    found: list[Indices | Steady] = [likely.get(word) or room(count) for word in range(words)]
    differing = _write(transpose, rows, found)
    if differing:
        others = [room(count) if word in differing else None for word in range(words)]
        _write(transpose, rows, others)
        found = [each if other is None else other for each, other in zip(found, others, strict=True)]
    return found


def _write(transpose: Callable[..., None], rows: Indices, columns: Sequence[Indices | Steady | None]) -> set[int]:
    """Fill the columns that have memory; gives the words that are not as steady as they should be."""
    steady = [(word, each.first, each.step, 0) for word, each in enumerate(columns) if isinstance(each, Steady)]
    compared = np.array([*steady, (0, 0, 0, 0)], np.int64)
    places = np.array([address_of(each) if isinstance(each, np.ndarray) else 0 for each in columns], np.int64)
    begin = ctypes.addressof(ctypes.c_char.from_buffer(rows[0].data))
    transpose(begin, rows.strides[0], *rows.shape, address_of(places), len(steady), address_of(compared))
    return {word for word, _, _, differs in compared.tolist() if differs}


def prepare(rows: int) -> None:
    """Before tables of so many rows together: compile the code, if that is worth while and the cache has it not."""
    if rows >= WORTH_COMPILING:
        _transpose()


def _is_there() -> bool:
    """Whether the code is loaded, or can be without a compiler."""
    return _transpose.cache_info().currsize > 0 or known(_text()) is not None


@cache
def _transpose() -> Callable[..., None] | None:
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
