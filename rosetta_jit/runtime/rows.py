"""Rows of a lane that are read together, and where the elements of their spans lie: all with numpy, nothing row by row.

Whatever `decode.many` has filled lies together and in order, so that its elements are a slice of their lane. Elements elsewhere (of
messages that were written to, of maps, of parts of a batch) are found by their numbers.

What is read may be changed by another thread meanwhile. `Lanes.consistent` reads again then; here nothing is read outside of a lane.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, assert_never

import numpy as np

from rosetta_jit.model.layout import SPAN_BYTES
from rosetta_jit.runtime.batches.transposing import Steady, transposed
from rosetta_jit.runtime.cells import dtype_of
from rosetta_jit.runtime.holder.record import Bit, Case, Cell, Presence
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.run import readable
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags: TypeAlias = NDArray[np.bool_]
    Indices: TypeAlias = NDArray[np.int64]
    Room: TypeAlias = Callable[[int], Indices]


def numpys(words: int) -> Indices:
    """Room for so many words."""
    return np.empty(words, np.int64)


def room_for(size: int, dtype: np.dtype[Any], room: Room) -> NDArray[Any]:
    """Room for so many values."""
    return room(-(-size * dtype.itemsize // 8)).view(dtype)[:size]


LONG = 256
"""Elements a span from which it is quicker to copy span by span than element by element."""

BLOCK = 256
"""Rows whose words are transposed together: as many as the innermost cache has room for."""


@dataclass(frozen=True, slots=True, eq=False)
class Words:
    """Some words of rows, transposed: a column of each, which lies together. The first is word ``start`` of each row.

    To read columns one by one out of rows costs three times as much: each passes through all of the rows' memory.
    """

    start: int
    words: Sequence[Indices | Steady]

    def column(self, index: int, dtype: np.dtype[Any]) -> NDArray[Any] | None:
        """The scalar that lies so many scalars behind the row's begin, if it is among the words."""
        word, part = divmod(index, 8 // dtype.itemsize)
        if not 0 <= word - self.start < len(self.words):
            return None
        found = self.words[word - self.start]
        values = found.values() if isinstance(found, Steady) else found
        return values.view(dtype)[part :: 8 // dtype.itemsize]

    def steady(self, index: int) -> Steady | None:
        """The word of this number, if it grows from row to row by as much as was likely."""
        found = self.words[index - self.start] if 0 <= index - self.start < len(self.words) else None
        return found if isinstance(found, Steady) else None


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Rows of a lane, one after the other or by their numbers.

    Attributes
    ----------
    at : slice or ndarray of int64
        Which they are.
    count : int
        How many.
    live : ndarray of bool or None
        Which of them have the value that is read; all, where it is None. What the others hold is of no meaning.
    words : Words or None
        Those words of the rows that are going to be read, where there are several.
    room : callable
        What gives memory for words.
    """

    at: slice | Indices
    count: int
    live: Flags | None = None
    words: Words | None = None
    room: Room = numpys

    @classmethod
    def first(cls, count: int, room: Room = numpys) -> Rows:
        """The first rows of a lane."""
        return cls(slice(0, count), count, room=room)

    def with_field(self, presence: Presence | None, lanes: Lanes) -> Rows:
        """The same rows, of which those are live that have a field."""
        present = _present(presence, lanes, self)
        if present is None:
            return self
        return Rows(self.at, self.count, present if self.live is None else present & self.live, self.words, self.room)

    def only(self, kept: Flags) -> Rows:
        """Some of the rows, all of which are live."""
        at = np.arange(self.count)[kept] + self.at.start if isinstance(self.at, slice) else self.at[kept]
        return Rows(at, int(kept.sum()), room=self.room)

    def reading(self, lanes: Lanes, lane: int, start: int, end: int, fixed: Iterable[tuple[Cell, int]] = ()) -> Rows:
        """The same rows, of which the words between two bytes are going to be read.

        ``fixed`` are spans among them, each with the number of elements that it is likely to have in all rows.
        """
        first, behind = start // 8, -(-end // 8)
        if self.words is not None or not first < behind:
            return self
        rows = lanes.row_words(lane, 0, lanes.capacity(lane))[:, first:behind]
        columns = None
        if isinstance(self.at, slice):
            steps = ((span.index + word - first, step) for span, length in fixed for word, step in enumerate((length, 0)))
            columns = transposed(rows[self.at], self.room, steps)
        if columns is None:
            words = self.room((behind - first) * self.count).reshape(behind - first, self.count)
            for begin in range(0, self.count, BLOCK):
                words[:, begin : begin + BLOCK] = rows[self._block(begin)].T
            columns = list(words)
        return Rows(self.at, self.count, self.live, Words(first, columns), self.room)

    def _block(self, begin: int) -> slice | Indices:
        if isinstance(self.at, slice):
            return slice(self.at.start + begin, min(self.at.start + begin + BLOCK, self.at.stop))
        return self.at[begin : begin + BLOCK]


def _present(presence: Presence | None, lanes: Lanes, rows: Rows) -> Flags | None:
    match presence:
        case None:
            return None
        case Bit(cell, mask):
            return read(lanes, cell, "u64", rows) & np.uint64(mask) != 0
        case Case(cell, number):
            return read(lanes, cell, "i64", rows) == number
        case _:
            assert_never(presence)


def read(lanes: Lanes, cell: Cell, scalar: str, rows: Rows, *, behind: int = 0) -> NDArray[Any]:
    """A cell of each row, zero where a row is not live; ``behind`` counts cells to the right. It shows nothing of the lanes."""
    dtype, index = dtype_of(scalar), cell.index + behind
    found = None if rows.words is None else rows.words.column(index, dtype)
    if found is None:
        buffer, count = lanes.buffers[cell.lane], lanes.capacity(cell.lane)
        found = np.ndarray((count,), dtype, buffer.data, index * dtype.itemsize, (cell.step * dtype.itemsize,))[rows.at].copy()
    if rows.live is None:
        return np.ascontiguousarray(found)
    return np.where(rows.live, found, dtype.type(0))


def spans(lanes: Lanes, span: Cell, rows: Rows) -> tuple[Indices, Indices]:
    """Where the elements of each row begin, and how many they are: 0 where a row is not live, ``~count`` where they are borrowed."""
    rows = rows.reading(lanes, span.lane, 8 * span.index, 8 * span.index + SPAN_BYTES)
    return read(lanes, span, "i64", rows), read(lanes, span, "i64", rows, behind=1)


def offsets(counts: Indices, room: Room = numpys) -> Indices:
    """Where each row's elements begin if they are put together, and the end of the last: shape (n + 1,)."""
    places = room(len(counts) + 1)
    places[0] = 0
    np.cumsum(counts, out=places[1:])
    return places


def fixed_together(lanes: Lanes, lane: int, span: Cell, length: int, rows: Rows) -> slice | None:
    """The elements of spans of one length that follow each other in a lane; None if they do not, or if only reading each would tell.

    Raises
    ------
    ValueError
        If a span leaves the lane.
    """
    if rows.words is None or rows.live is not None or not rows.count * length:
        return None
    starts, counts = rows.words.steady(span.index), rows.words.steady(span.index + 1)
    if starts is None or counts is None or starts.step != length or (counts.first, counts.step) != (length, 0):
        return None
    return _within(starts.first, starts.first + length * rows.count, lanes.used(lane))


def elements(starts: Indices, counts: Indices, used: int, room: Room = numpys) -> Rows:
    """The elements of spans of a lane, of which so many rows are in use.

    Raises
    ------
    ValueError
        If a span leaves the lane.
    """
    whole = together(starts, counts, used)
    if whole is not None:
        return Rows(whole, whole.stop - whole.start, room=room)
    total = int(counts.sum())
    return Rows(np.repeat(starts - offsets(counts)[:-1], counts) + np.arange(total), total, room=room)


def fixed_elements(starts: Indices, counts: Indices, length: int, used: int, room: Room = numpys) -> Rows:
    """The same of arrays of fixed length. One that is not there has elements that are not live."""
    there = counts == length
    if there.all():
        return elements(starts, counts, used, room)
    together(starts[there], counts[there], used)
    numbers = (starts[:, None] + np.arange(length)).astype(np.int64)
    numbers[~there] = 0
    return Rows(numbers.reshape(-1), numbers.size, np.repeat(there, length), room=room)


def lent(lanes: Lanes, lane: int, starts: Indices, counts: Indices) -> tuple[NDArray[Any], Indices, Indices]:
    """The numbers of a lane with the bytes that are borrowed, and where those of each span are among them.

    Raises
    ------
    ValueError
        If there is nothing to borrow from.
    """
    own = lanes.arrays[lane][: lanes.used(lane)].view(np.ndarray)
    borrowed = counts < 0
    if not borrowed.any():
        return own, starts, counts
    lender = lanes.source[0]
    if lender is None:
        raise ValueError("what was borrowed from is gone")
    source, sizes = readable(lender), np.where(borrowed, ~counts, counts)
    if borrowed.all():
        return source, starts, sizes
    return np.concatenate([source, own]), np.where(borrowed, starts, starts + len(source)), sizes


def picked(values: NDArray[Any], starts: Indices, counts: Indices, room: Room = numpys) -> NDArray[Any]:
    """The values of spans, one after the other; not copied if they already lie so. Long spans are copied to ``room``.

    Raises
    ------
    ValueError
        If a span leaves the values.
    """
    whole = together(starts, counts, len(values))
    if whole is not None:
        return values[whole]
    total = int(counts.sum())
    if total >= LONG * counts.size:
        pieces = [values[start : start + count] for start, count in zip(starts.tolist(), counts.tolist(), strict=True)]
        return np.concatenate(pieces, out=room_for(total, values.dtype, room))
    return values[elements(starts, counts, len(values)).at]


def together(starts: Indices, counts: Indices, used: int) -> slice | None:
    """The elements of spans that follow each other without gaps; None if they do not.

    Raises
    ------
    ValueError
        If a span leaves its lane, of which so many rows are in use.
    """
    least = int(counts.min()) if len(counts) else 0
    if least == 0:
        filled = counts != 0
        starts, counts = starts[filled], counts[filled]
    if not len(counts):
        return slice(0, 0)
    ends = starts + counts
    is_whole = least >= 0 and bool((starts[1:] == ends[:-1]).all())
    first, end = (int(starts[0]), int(ends[-1])) if is_whole else (int(starts.min()), int(ends.max()))
    found = _within(first if least >= 0 else least, end, used)
    return found if is_whole else None


def _within(first: int, end: int, used: int) -> slice:
    """Elements of a lane, of which so many rows are in use; ValueError if it has not all of them."""
    if first < 0 or end > used:
        raise ValueError(f"an array leaves its lane of {used} rows")
    return slice(first, end)
