"""Columns: one field of every row of a lane, as numpy sees it.

A number is a strided array. An array of anything is `Ragged`: the column of its elements' lane, and where each row's elements lie in it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, assert_never

import numpy as np

from rosetta_jit.model.layout import scalar_of
from rosetta_jit.runtime.batches.nested import Columns, Ragged, refuse_others
from rosetta_jit.runtime.batches.texts import Texts
from rosetta_jit.runtime.cells import dtype_of
from rosetta_jit.runtime.holder.message import Message, place
from rosetta_jit.runtime.holder.paths import entries_to
from rosetta_jit.runtime.holder.record import Bit, Blob, Case, Cell, Child, Items, Node, Numbers, Pairs, Presence, Record, Scalar, Text
from rosetta_jit.runtime.lanes import Lanes

if TYPE_CHECKING:
    from numpy.typing import NDArray


class WithColumns:
    """Whatever has columns as attributes beside its slots."""

    __slots__: tuple[str, ...] = ()

    def __setattr__(self, name: str, value: object) -> None:
        if name in self.__slots__:
            object.__setattr__(self, name, value)
        else:
            refuse_others(name, getattr(self, name), value)


def cells(lanes: Lanes, cell: Cell, scalar: str, rows: int, *, behind: int = 0) -> NDArray[Any]:
    """A cell of the first rows of a lane, strided; ``behind`` counts cells to the right."""
    dtype = dtype_of(scalar)
    buffer = lanes.buffers[cell.lane]
    return np.ndarray((rows,), dtype, buffer.data, (cell.index + behind) * dtype.itemsize, (cell.step * dtype.itemsize,))


def column(node: Node, lanes: Lanes, rows: int, path: list[str]) -> Any:
    """The column of a node, or of a field inside it that a path names.

    Raises
    ------
    KeyError
        If there is no such field.
    TypeError
        If messages contain each other without bound there: those have no columns.
    """
    match node:
        case Scalar(cell, type_):
            return cells(lanes, cell, scalar_of(type_), rows)
        case Text(span, lane, _) | Blob(span, lane):
            kind = "text" if isinstance(node, Text) else "bytes"
            starts, counts = _spans(lanes, span, rows)
            borrowed = lanes.source[0]
            source = None if borrowed is None else memoryview(borrowed).cast("B")
            return Texts(_elements(lanes, lane), starts, counts, kind, source)
        case Numbers(span, lane):
            return Ragged(_elements(lanes, lane), *_spans(lanes, span, rows))
        case Items(span, lane, element):
            return Ragged(column(element, lanes, lanes.used(lane), path), *_spans(lanes, span, rows))
        case Pairs(span, lane, _, key, value):
            used = lanes.used(lane)
            pairs = Columns({"key": column(key, lanes, used, []), "value": column(value.node, lanes, used, path)})
            return Ragged(pairs, *_spans(lanes, span, rows), "map")
        case Record():
            if lanes.plan.layout.lanes[node.lane].links is not None and node.lane:
                raise TypeError(f"messages of {node.struct} contain each other: read them one by one")
            if path:
                return column(node.entries[path[0]].node, lanes, rows, path[1:])
            return Columns((name, column(entry.node, lanes, rows, [])) for name, entry in node.entries.items())
        case Child():
            raise TypeError(f"messages of {node.record.struct} contain each other: read them one by one")
        case _:
            assert_never(node)


def column_of(message: Message, path: str) -> Any:
    """The column of an array of structs, or whatever else a path names, of one message."""
    lanes, row = place(message)
    entries_to(message.access_.record, path)
    first, *rest = path.split(".")
    return _at(column(message.access_.record.entries[first].node, lanes, row + 1, rest), row)


def _at(found: Any, row: int) -> Any:
    match found:
        case Columns():
            return Columns((name, _at(each, row)) for name, each in found.items())
        case _:
            return found[row]


def presence_mask(presence: Presence | None, lanes: Lanes, rows: int) -> NDArray[np.bool_]:
    """Which rows have a field."""
    match presence:
        case None:
            return np.ones(rows, np.bool_)
        case Bit(cell, mask):
            return cells(lanes, cell, "u64", rows) & np.uint64(mask) != 0
        case Case(cell, number):
            return cells(lanes, cell, "i64", rows) == number
        case _:
            assert_never(presence)


def _elements(lanes: Lanes, lane: int) -> NDArray[Any]:
    return lanes.arrays[lane][: lanes.used(lane)].view(np.ndarray)


def _spans(lanes: Lanes, span: Cell, rows: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Where the elements of each row lie: read-only, because accessors and kernels go by it."""
    starts, counts = cells(lanes, span, "i64", rows), cells(lanes, span, "i64", rows, behind=1)
    starts.flags.writeable = counts.flags.writeable = False
    return starts, counts
