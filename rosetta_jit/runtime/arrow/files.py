"""Tables into files, one after another, so that no more than one is in memory: Parquet, Arrow, CSV, and numpy's archives."""

from __future__ import annotations

import json
from importlib import import_module
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pyarrow as pa

from rosetta_jit.runtime.arrow.tables import flat

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

ROWS = 1 << 17
"""Rows that Parquet keeps together, and readers can skip together."""


def write_tables(tables: Iterable[pa.Table], path: Path, suffix: str) -> None:
    """Write tables of one schema; ValueError if no file has such a suffix."""
    match suffix:
        case ".parquet":
            _write(import_module("pyarrow.parquet").ParquetWriter, _grouped(tables), path)
        case ".arrow":
            _write(import_module("pyarrow").ipc.new_file, tables, path)
        case ".csv":
            _write(import_module("pyarrow.csv").CSVWriter, map(_for_text, tables), path)
        case ".npz":
            _write_archive(tables, path)
        case _:
            raise ValueError(f"tables are written as .parquet, .arrow, .csv and .npz, not as {suffix}")


def _write(make: Any, tables: Iterable[pa.Table], path: Path) -> None:
    writer = None
    with path.open("wb") as file:
        for table in tables:
            writer = writer or make(file, table.schema)
            writer.write_table(table)
        if writer is not None:
            writer.close()


def _grouped(tables: Iterable[pa.Table]) -> Iterator[pa.Table]:
    """The same in tables of more rows."""
    waiting, count = list[pa.Table](), 0
    for table in tables:
        waiting.append(table)
        count += table.num_rows
        if count >= ROWS:
            yield pa.concat_tables(waiting)
            waiting, count = [], 0
    if waiting:
        yield pa.concat_tables(waiting)


def _for_text(given: pa.Table) -> pa.Table:
    """A table whose columns CSV has: structs flat, lists, maps and bytes as JSON."""
    types, table = import_module("pyarrow.types"), cast("Any", flat(given))
    for place, column in enumerate(table.schema):
        if types.is_nested(column.type) or types.is_large_binary(column.type) or types.is_fixed_size_binary(column.type):
            texts = [None if each is None else json.dumps(each, default=_plain) for each in table.column(column.name).to_pylist()]
            table = table.set_column(place, column.name, pa.array(texts, pa.large_string()))
        elif types.is_dictionary(column.type):
            table = table.set_column(place, column.name, table.column(column.name).cast(pa.large_string()))
    return table


def _plain(value: object) -> object:
    return value.hex() if isinstance(value, bytes) else str(value)


def _write_archive(tables: Iterable[pa.Table], path: Path) -> None:
    """An array a column, as `rosetta-jit decode --npz` writes them: the elements of lists end to end, beside ``NAME.offsets``."""
    table = flat(pa.concat_tables(list(tables)))
    columns: dict[str, Any] = {}
    for name in table.schema.names:
        columns |= _arrays(name, table.column(name).combine_chunks())
    with path.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **columns)


def _arrays(name: str, column: Any) -> dict[str, Any]:
    types = import_module("pyarrow.types")
    column = column.combine_chunks() if hasattr(column, "combine_chunks") else column
    if types.is_fixed_size_list(column.type):
        inner = column.flatten()
        if not types.is_nested(inner.type):
            return {name: inner.to_numpy(zero_copy_only=False).reshape(len(column), column.type.list_size)}
    elif types.is_large_list(column.type) and not types.is_nested(column.type.value_type):
        offsets = column.offsets.to_numpy() - column.offsets[0].as_py()
        return {name: _numbers(column.flatten()), f"{name}.offsets": offsets}
    elif not types.is_nested(column.type):
        return {name: _numbers(column)}
    return {name: np.array([json.dumps(each, default=_plain) for each in column.to_pylist()])}


def _numbers(column: Any) -> Any:
    """A column as an array: texts as texts of numpy, bytes in hexadecimal digits."""
    found = column.to_numpy(zero_copy_only=False)
    return found if found.dtype != object else np.array([_plain(each) if isinstance(each, bytes) else str(each) for each in found], np.str_)
