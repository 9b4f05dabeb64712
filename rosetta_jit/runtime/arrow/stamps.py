"""Arrow for tables of logs: nanoseconds as timestamps, and tables put together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

from rosetta_jit.runtime.arrow.times import stamps_array

if TYPE_CHECKING:
    from numpy.typing import NDArray


def with_times(table: pa.Table, times_ns: Mapping[str, NDArray[np.int64]]) -> pa.Table:
    """A table with columns of nanoseconds since 1970 in front, as timestamps; a name that a field has gets an underscore."""
    taken = set(table.schema.names)
    if not taken:  # such a table has no rows to which one could add
        columns = {name: _column(times) for name, times in times_ns.items()}
        schema = pa.schema([pa.field(name, column.type) for name, column in columns.items()])
        return pa.Table.from_batches([pa.RecordBatch.from_arrays(list(columns.values()), schema=schema)])
    for place, (name, times) in enumerate(times_ns.items()):
        table = table.add_column(place, f"{name}_" if name in taken else name, _column(times))
    return table


def _column(times_ns: NDArray[np.int64]) -> pa.Array:
    """Times as timestamps. They are copied: the memory that they come in is used again."""
    return stamps_array(np.array(times_ns, np.int64), "ns")


def concatenated(tables: Sequence[pa.Table]) -> pa.Table:
    """One table, which shows the memory of all."""
    return pa.concat_tables(tables)
