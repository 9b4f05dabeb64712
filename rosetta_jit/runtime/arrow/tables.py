"""Batches as Arrow tables: which columns they have, and what they are called."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
from pyarrow.types import is_struct

from rosetta_jit.errors import DecodeError
from rosetta_jit.runtime.arrow.arrays import Form, Place, entry_array, reading_all, room
from rosetta_jit.runtime.holder.paths import entries_to
from rosetta_jit.runtime.holder.record import Record
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.rows import Rows

if TYPE_CHECKING:
    from rosetta_jit.runtime.rows import Indices


def record_batch(root: Record, lanes: Lanes, count: int, names: Sequence[str], form: Form) -> pa.RecordBatch:
    """Some fields of messages; a field of a nested message is named with dots."""
    for each in (*form.times, *names):
        entries_to(root, each)
    rows = Rows.first(count, room)
    if len(names) == len(root.entries):
        rows = reading_all(root, lanes, rows)
    found = [_column(root, Place(lanes, form, rows), name) for name in names]
    fields = [pa.field(name, array.type, nullable) for name, (array, nullable) in zip(names, found, strict=True)]
    return pa.RecordBatch.from_arrays([array for array, _ in found], schema=pa.schema(fields))


def table(batch: pa.RecordBatch) -> pa.Table:
    """A table of one chunk."""
    return pa.Table.from_batches([batch])


def taken(table: pa.Table, numbers: Indices) -> pa.Table:
    """Some rows of a table, in memory of their own. Unlike `Table.take` with an array of numpy, this does not import pandas."""
    return table.take(pa.Array.from_buffers(pa.int64(), len(numbers), [None, pa.py_buffer(np.ascontiguousarray(numbers, np.int64))]))


def flat(table: pa.Table) -> pa.Table:
    """A table with each field of its structs, and of those within, as a column of its own."""
    while any(is_struct(each.type) for each in table.schema):
        table = table.flatten()
    return table


def with_errors(table: pa.Table, name: str, errors: Mapping[int, DecodeError], numbers: Iterable[int]) -> pa.Table:
    """A table with one column more: the errors of messages of such numbers, as text; raises ValueError if a field has that name."""
    if name in table.schema.names:
        raise ValueError(f"errors={name!r} is the name of a column: give the column of errors another one")
    texts = [str(errors[number]) if number in errors else None for number in numbers]
    return table.append_column(name, pa.array(texts, pa.large_string()))


def _column(root: Record, place: Place, name: str) -> tuple[pa.Array, bool]:
    """The array of a field, and whether it can be null."""
    record, nullable = root, False
    *around, last = name.split(".")
    for each in around:
        entry = record.entries[each]
        if not isinstance(entry.node, Record):
            raise KeyError(f"`{each}` of `{name}` is an array or a map: take it as a whole")
        place = place.at(place.rows.with_field(entry.presence, place.lanes), f"{place.path}.{each}")
        record, nullable = entry.node, nullable or entry.presence is not None
    entry = record.entries[last]
    nullable = nullable or entry.presence is not None
    return entry_array(entry, place, nullable=nullable), nullable
