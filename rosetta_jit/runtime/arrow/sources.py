"""Whatever has Arrow's interface as columns: tables, frames of pandas and polars, relations of DuckDB.

pandas has one value, NaN, for what is missing and for what is no number, and makes floats of integers where one is missing. Which of them
is meant only the field can tell, so that its columns say that they have such gaps.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from pyarrow import types

from rosetta_jit.errors import ValuesError
from rosetta_jit.runtime.arrow.arrays import Form
from rosetta_jit.runtime.arrow.plain import plain
from rosetta_jit.runtime.arrow.tables import record_batch
from rosetta_jit.runtime.holder.record import Record
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.runtime.rows import Flags

_INDEX = re.compile("__index_level_[0-9]+__")
"""How pandas names an index without a name, which is no field."""


@dataclass(frozen=True, slots=True, eq=False)
class Columns:
    """Columns by the names of their fields, all of so many rows.

    Attributes
    ----------
    has_gaps
        Whether a null of floats may be NaN, and floats may be integers, as in frames of pandas.
    """

    arrays: Mapping[str, pa.Array]
    rows: int
    has_gaps: bool = False


def columns_of(source: Any, root: Record, empty: Lanes) -> Columns:
    """The columns of a source for a type, of which there are ``empty`` lanes. Columns named with dots become those of nested messages.

    Raises
    ------
    TypeError
        If the source has no interface of Arrow's.
    ValuesError
        If two columns have one name, or one has values of several types, or a type that pyarrow does not know, or is damaged.
    """
    pandas = sys.modules.get("pandas")
    if pandas is not None and isinstance(source, pandas.DataFrame):
        found = [(str(name), _of_pandas(str(name), series, root, empty)) for name, series in _series(source)]
        return Columns(_nested(root, _by_name(found), ""), len(source), has_gaps=True)
    table = _table_of(source)
    found = [(name, _sound(name, table.column(name)).combine_chunks()) for name in _distinct(table.schema.names)]
    return Columns(_nested(root, _by_name(found), ""), table.num_rows)


def _table_of(source: Any) -> pa.Table:
    try:
        if hasattr(source, "__arrow_c_stream__"):
            return pa.RecordBatchReader.from_stream(source).read_all()
        if hasattr(source, "__arrow_c_array__"):
            return pa.table(source)
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
        raise ValuesError("", f"a column has a type that pyarrow does not know: {error}") from None
    raise TypeError(f"a batch, a list of messages, or a table or frame with Arrow's interface is needed, not {type(source).__name__}")


def _sound(name: str, column: Any) -> Any:
    """A column whose offsets stay in its buffers, and whose texts are texts: Arrow looks at neither, nor when it reads a file."""
    try:
        column.validate(full=True)
    except pa.ArrowInvalid as error:
        raise ValuesError(f".{name}", f"the column is damaged: {error}") from None
    return column


def _distinct(names: Sequence[str]) -> Sequence[str]:
    """The names of columns, without those of an index that has none."""
    names = [name for name in names if not _INDEX.fullmatch(name)]
    if len(set(names)) < len(names):
        raise ValuesError("", f"several columns have the same name among {', '.join(names)}")
    return names


def _by_name(columns: Sequence[tuple[str, pa.Array]]) -> dict[str, pa.Array]:
    _distinct([name for name, _ in columns])
    return {name: plain(array) for name, array in columns}


# --- pandas --------------------------------------------------------------------------------------------------------------


def _series(frame: Any) -> list[tuple[object, Any]]:
    """The columns of a frame, and the levels of its index that have a name, which are columns, too."""
    index = frame.index
    levels = [(name, index.get_level_values(level)) for level, name in enumerate(index.names) if name is not None]
    return [*((name, frame.iloc[:, number]) for number, name in enumerate(frame.columns)), *levels]


def _of_pandas(name: str, series: Any, root: Record, empty: Lanes) -> pa.Array:
    """A column of pandas. Of what type objects are, they say themselves; those of maps, and those that do not, are of the field's."""
    wanted = _type_of(name, root, empty) if series.dtype == np.dtype(object) else None
    tried = [wanted] if wanted is not None and _has_map(wanted) else [None] if wanted is None else [None, wanted]
    why = ""
    for type_ in tried:
        try:
            return _converted(name, series, type_)
        except (pa.ArrowInvalid, pa.ArrowTypeError, pa.ArrowNotImplementedError) as error:
            why = error.args[0]
    raise ValuesError(f".{name}", f"the column has values of several types, or of another one: {why}")


def _converted(name: str, series: Any, type_: pa.DataType | None) -> pa.Array:
    found = _sound(name, pa.Array.from_pandas(series, type=type_))
    return found.combine_chunks() if isinstance(found, pa.ChunkedArray) else found


def _type_of(name: str, root: Record, empty: Lanes) -> pa.DataType | None:
    """The type that `to_arrow` gives a field; None where there is no such field, or no such type."""
    try:
        return record_batch(root, empty, 0, [name], Form()).schema.field(name).type
    except (KeyError, TypeError):
        return None


def _has_map(type_: pa.DataType) -> bool:
    return types.is_map(type_) or any(_has_map(type_.field(number).type) for number in range(type_.num_fields))


# --- names with dots -----------------------------------------------------------------------------------------------------


def _nested(record: Record, columns: Mapping[str, pa.Array], path: str) -> dict[str, pa.Array]:
    """Columns named with dots as columns of structs. A struct that can be absent is so where all of its columns are null."""
    whole, parts = dict[str, pa.Array](), dict[str, dict[str, pa.Array]]()
    for name, array in columns.items():
        first, dot, rest = name.partition(".")
        entry = record.entries.get(first)
        if dot and name not in record.entries and entry is not None and isinstance(entry.node, Record):
            parts.setdefault(first, {})[rest] = array
        else:
            whole[name] = array
    for first, found in parts.items():
        if first in whole:
            raise ValuesError(f"{path}.{first}", f"it is a column, and so is its part {next(iter(found))}")
        entry = record.entries[first]
        assert isinstance(entry.node, Record)
        inner = _nested(entry.node, found, f"{path}.{first}")
        absent = pa.array(_absent(found), pa.bool_()) if entry.presence is not None else None
        whole[first] = pa.StructArray.from_arrays(list(inner.values()), list(inner), mask=absent)
    return whole


def _absent(columns: Mapping[str, pa.Array]) -> Flags:
    """The rows in which all columns are null."""
    return np.logical_and.reduce([each.is_null().to_numpy(zero_copy_only=False) for each in columns.values()])
