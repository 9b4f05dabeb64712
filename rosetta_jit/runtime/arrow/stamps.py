"""What tables of logs need of Arrow: nanoseconds as timestamps, and tables put together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray


def with_times(table: pa.Table, times_ns: Mapping[str, NDArray[np.int64]]) -> pa.Table:
    """A table with columns of nanoseconds since 1970 in front, as timestamps; a name that a field has gets an underscore."""
    taken = set(table.schema.names)
    if not taken:  # such a table has no rows to which one could add
        return pa.table({name: np.array(times, np.int64).view("datetime64[ns]") for name, times in times_ns.items()})
    for place, (name, times) in enumerate(times_ns.items()):
        column = pa.array(np.array(times, np.int64).view("datetime64[ns]"))
        table = table.add_column(place, f"{name}_" if name in taken else name, column)
    return table


def concatenated(tables: Sequence[pa.Table]) -> pa.Table:
    """One table, which shows the memory of all."""
    return pa.concat_tables(tables)
