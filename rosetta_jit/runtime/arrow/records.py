"""Messages as records, a row each with the fields of nested messages beside the others: what pandas' constructor takes.

It reads neither Arrow's interfaces nor arrays with named fields, but an array of the standard library's dataclasses, whose
fields become columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, make_dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from pyarrow.types import is_dictionary

from rosetta_jit.runtime.arrow.tables import flat

if TYPE_CHECKING:
    import pyarrow as pa
    from numpy.typing import NDArray


class _Record:
    """A row: attributes that are named as the columns of its table."""

    def __init__(self, names: Sequence[str], values: Sequence[Any]) -> None:
        vars(self).update(zip(names, values, strict=True))

    def __repr__(self) -> str:
        return f"Record({vars(self)})"


def check_asked(dtype: object, *, copy: bool | None) -> None:
    """Refuse an array of another type than ``object``, and one that is no copy: TypeError, ValueError."""
    if dtype is not None and np.dtype(cast("Any", dtype)) != np.object_:
        raise TypeError("messages are no array of numbers: take one column of them, or `to_pandas()`, `to_arrow()` of the batch")
    if copy is False:
        raise ValueError("records of messages are made: there is nothing to show without a copy")


def records(table: pa.Table) -> NDArray[np.object_]:
    """The rows of a table, shape (n,)."""
    flattened = flat(table)
    return of_values(flattened.schema.names, [_values(flattened.column(name)) for name in flattened.schema.names])


def of_values(names: Sequence[str], columns: Sequence[Sequence[Any]]) -> NDArray[np.object_]:
    """Rows of Python's own values, shape (n,)."""
    make = _class(names)
    found = np.empty(len(columns[0]) if columns else 0, np.object_)
    for index, values in enumerate(zip(*columns, strict=True)):
        found[index] = make(names, values)
    return found


def _class(names: Sequence[str]) -> type[_Record]:
    """A dataclass with fields of such names, which need not be Python's."""
    places = [f"field_{index}" for index in range(len(names))]
    made = make_dataclass("Record", places, bases=(_Record,), init=False, repr=False, eq=False)
    for field, name in zip(fields(made), names, strict=True):
        field.name = name
    return made


def _values(column: pa.ChunkedArray) -> list[Any]:
    """Python's own values, arrays as numpy's."""
    values = column.cast(column.type.value_type) if is_dictionary(column.type) else column
    return values.to_numpy().tolist()
