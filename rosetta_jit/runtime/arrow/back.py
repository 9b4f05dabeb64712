"""Arrow arrays as lanes: the way back of `rosetta_jit.runtime.arrow`, column by column with numpy. The columns are those of `sources`.

Nothing is altered: a value that its field cannot hold exactly, of another kind, or null where the field cannot be absent, is one error
that names the field. Columns may be missing; their fields stay as they are in a new message. Nulls are taken out where they stand for
absence, so that all arrays below have none.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, assert_never

import numpy as np
import pyarrow as pa
from pyarrow import types

from rosetta_jit.errors import ValuesError
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.limits import MAX_INITIAL_BYTES
from rosetta_jit.runtime.arrow.leaves import blob_of, listed_of, numbers_of, refused, solid, text_of
from rosetta_jit.runtime.arrow.times import moment_columns
from rosetta_jit.runtime.cells import dtype_of
from rosetta_jit.runtime.holder.paths import no_such_field
from rosetta_jit.runtime.holder.record import (
    Bit,
    Blob,
    Case,
    Cell,
    Child,
    Choice,
    Entry,
    Items,
    Node,
    Numbers,
    Pairs,
    Record,
    Scalar,
    Spanned,
    Text,
)
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.rows import offsets
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.runtime.arrow.sources import Columns
    from rosetta_jit.runtime.rows import Flags, Indices


@dataclass(frozen=True, slots=True, eq=False)
class _Target:
    """Rows of a lane, which are new and zero, and their path; ``has_gaps`` as of `Columns`."""

    lanes: Lanes
    rows: Indices
    path: str = ""
    has_gaps: bool = False

    def column(self, cell: Cell, scalar: str, behind: int = 0) -> NDArray[Any]:
        """A cell of all rows of the lane."""
        dtype, buffer = dtype_of(scalar), self.lanes.buffers[cell.lane]
        count, size = self.lanes.capacity(cell.lane), dtype.itemsize
        return np.ndarray((count,), dtype, buffer.data, (cell.index + behind) * size, (cell.step * size,))

    def within(self, name: str) -> _Target:
        return _Target(self.lanes, self.rows, self.path + name, self.has_gaps)

    def only(self, chosen: Flags) -> _Target:
        return _Target(self.lanes, self.rows[chosen], self.path, self.has_gaps)


def write_columns(root: Record, lanes: Lanes, columns: Columns) -> None:
    """Make columns fields of new messages, which are zero yet.

    Raises
    ------
    ValuesError
        If a column is of no field, or a field cannot take its values.
    """
    _write_record(root, columns.arrays, _Target(lanes, np.arange(columns.rows), has_gaps=columns.has_gaps))


def _write_record(record: Record, columns: Mapping[str, pa.Array], target: _Target) -> None:
    for name in columns:
        if name not in record.entries:
            raise ValuesError(f"{target.path}.{name}", no_such_field(record, name))
    for name, entry in record.entries.items():
        _write_entry(entry, columns.get(name), target.within(f".{name}"))
    for name, entry in record.entries.items():
        if isinstance(entry.node, Scalar) and entry.node.choice is not None:
            _settle_choice(record, entry.node.choice, target, has_tag=name in columns)


def _write_entry(entry: Entry, array: pa.Array | None, target: _Target) -> None:
    if array is None:
        if entry.presence is None:
            _write_initial(entry.node, target)
        return
    match entry.presence:
        case None:
            _write(entry.node, array, target)
        case Bit(cell, mask):
            there = target.only(_valid(array))
            there.column(cell, "u64")[there.rows] |= np.uint64(mask)
            _write(entry.node, array.drop_null(), there)
        case Case(cell, number):
            there = target.only(_valid(array))
            cases = there.column(cell, "i64")
            if cases[there.rows].any():
                twice = np.flatnonzero(_valid(array) & (cases[target.rows] != 0))
                raise ValuesError(target.path, f"value {twice[0]} is a second case of one union")
            cases[there.rows] = number
            _write(entry.node, array.drop_null(), there)
        case _:
            assert_never(entry.presence)


def _valid(array: pa.Array) -> Flags:
    return np.asarray(array.is_valid().to_numpy(zero_copy_only=False), np.bool_)


def _write(node: Node, array: pa.Array, target: _Target) -> None:
    """Make the elements of an array those of the rows. None of them may be null, unless that is a float which can be NaN."""
    if not isinstance(node, Scalar):
        array = solid(array, target.path)
        if types.is_null(array.type):
            return  # there are no elements
    match node:
        case Scalar(cell, type_):
            target.column(cell, scalar_of(type_))[target.rows] = numbers_of(type_, array, target.path, has_gaps=target.has_gaps)
        case Text(_, _, type_):
            data, counts = text_of(type_, array, target.path)
            _check(counts, None, type_.maximum, target.path)
            _put(node, data, counts, target)
        case Blob(_, _, length, maximum):
            data, counts = blob_of(array, target.path)
            _check(counts, length, maximum, target.path)
            _put(node, data, counts, target)
        case Numbers(_, _, type_, length, maximum):
            values, counts = listed_of(array, target.path)
            _check(counts, length, maximum, target.path)
            _put(node, numbers_of(type_, values, f"{target.path}[]", has_gaps=target.has_gaps), counts, target)
        case Items(_, _, element, length, maximum):
            values, counts = listed_of(array, target.path)
            _check(counts, length, maximum, target.path)
            _write(element, values, _extended(node, counts, target))
        case Pairs():
            pairs, counts = listed_of(array, target.path)
            _write(node.record, pairs, _extended(node, counts, target))
        case Record():
            _write_struct(node, array, target)
        case Child():
            raise _recursive(node.record, target)
        case _:
            assert_never(node)


def _write_struct(record: Record, array: pa.Array, target: _Target) -> None:
    if target.lanes.plan.layout.lanes[record.lane].links is not None:
        raise _recursive(record, target)
    if types.is_timestamp(array.type):
        _write_record(record, moment_columns(record, array, target.path), target)
        return
    if not types.is_struct(array.type):
        raise refused("a struct", array, target.path)
    names = [array.type.field(index).name for index in range(array.type.num_fields)]
    _write_record(record, dict(zip(names, array.flatten(), strict=True)), target)


def _recursive(record: Record, target: _Target) -> TypeError:
    path = target.path.lstrip(".")
    return TypeError(f"`{path}`: messages of {record.struct} contain each other, for which Arrow has no type; leave the column out")


def _write_initial(node: Node, target: _Target) -> None:
    """What a field is in a new message: arrays of fixed length have their elements, unless those would be very many."""
    match node:
        case Blob(_, lane, int(length)) | Numbers(_, lane, _, int(length)):
            dtype = target.lanes.plan.dtypes[lane]
            if length * dtype.itemsize <= MAX_INITIAL_BYTES:
                _put(node, np.zeros(len(target.rows) * length, dtype), np.full(len(target.rows), length), target)
        case Items(_, lane, element, int(length)):
            if length * target.lanes.plan.strides[lane] <= MAX_INITIAL_BYTES:
                _write_initial(element, _extended(node, np.full(len(target.rows), length), target))
        case Record():
            _write_record(node, {}, target)
        case Scalar() | Text() | Blob() | Numbers() | Items() | Pairs() | Child():
            pass
        case _:
            assert_never(node)


def _put(node: Spanned, data: NDArray[Any], counts: Indices, target: _Target) -> None:
    """Let rows refer to numbers, one span behind the other."""
    start = target.lanes.take(node.lane, len(data))
    target.lanes.arrays[node.lane][start : start + len(data)] = data
    _refer(node, start, counts, target)


def _extended(node: Spanned, counts: Indices, target: _Target) -> _Target:
    """Let rows refer to new rows of another lane, which are the target of what follows."""
    total = int(counts.sum())
    start = target.lanes.take(node.lane, total)
    _refer(node, start, counts, target)
    return _Target(target.lanes, np.arange(start, start + total), f"{target.path}[]", target.has_gaps)


def _refer(node: Spanned, start: int, counts: Indices, target: _Target) -> None:
    target.column(node.span, "i64")[target.rows] = offsets(counts)[:-1] + start
    target.column(node.span, "i64", 1)[target.rows] = counts


def _check(counts: Indices, length: int | None, maximum: int | None, path: str) -> None:
    if length is not None:
        wrong, allowed = np.flatnonzero(counts != length), f"has {length}"
    elif maximum is not None:
        wrong, allowed = np.flatnonzero(counts > maximum), f"allows {maximum}"
    else:
        return
    if len(wrong):
        raise ValuesError(path, f"value {wrong[0]} has {counts[wrong[0]]} elements where the type {allowed}")


def _settle_choice(record: Record, choice: Choice, target: _Target, *, has_tag: bool) -> None:
    """Bring a union and its discriminator together: without a column of its own, the discriminator follows the case."""
    scalar = next(entry.node for entry in record.entries.values() if isinstance(entry.node, Scalar) and entry.node.choice is choice)
    tags = target.column(choice.tag, scalar_of(scalar.type))
    cases = target.column(choice.cases[0].cell, "i64")
    if not has_tag:
        for case in choice.cases:
            tags[target.rows[cases[target.rows] == case.number]] = case.label
        first = choice.selected(0)
        if first:
            rest = target.only(cases[target.rows] == 0)
            cases[rest.rows] = first
            entry = next(each for each in record.entries.values() if each.presence is choice.cases[first - 1])
            _write_initial(entry.node, rest.within(f".{entry.name}"))
        return
    numbers, places = np.unique(tags[target.rows], return_inverse=True)
    selected = np.array([choice.selected(int(number)) for number in numbers], np.int64)[places]
    wrong = np.flatnonzero(selected != cases[target.rows])
    if len(wrong):
        raise ValuesError(target.path or ".", f"of value {wrong[0]} the discriminator selects another case than the one that is there")
