"""Tables into files, one after another, so that no more than one is in memory: Parquet, Arrow, CSV, and numpy's archives."""

from __future__ import annotations

import json
from collections.abc import Iterable
from importlib import import_module
from typing import TYPE_CHECKING, Any, Self, cast

import pyarrow as pa

from rosetta_jit.runtime.arrow.archive import plain, write_archive
from rosetta_jit.runtime.arrow.tables import flat

if TYPE_CHECKING:
    from pathlib import Path

ROWS, BYTES = 1 << 17, 16 << 20
"""What Parquet keeps together, in a group of rows that readers can skip: so many rows, or so many bytes."""


def write_tables(tables: Iterable[pa.Table], path: Path, suffix: str) -> None:
    """Write tables of one schema; ValueError if no file has such a suffix."""
    if suffix == ".npz":
        write_archive(tables, path)
        return
    with TableFile(path, suffix) as file:
        for table in tables:
            file.write(table)


class TableFile:
    """A file of tables of one schema that come one after another; without any it is empty. ValueError if no file has such a suffix.

    Attributes
    ----------
    waiting_bytes : int
        What is in memory until a group of rows is full.
    """

    def __init__(self, path: Path, suffix: str) -> None:
        self._new = _maker(suffix)
        self._groups = suffix == ".parquet"
        self._file = path.open("wb")
        self._writer: Any = None
        self._waiting: list[pa.Table] = []
        self._rows = self.waiting_bytes = 0

    def write(self, table: pa.Table) -> None:
        """Add a table."""
        self._waiting.append(table)
        self._rows += table.num_rows
        self.waiting_bytes += table.nbytes
        if not self._groups or self._rows >= ROWS or self.waiting_bytes >= BYTES:
            self.flush()

    def flush(self) -> None:
        """Write what waits, as one group of rows."""
        if self._waiting:
            table = pa.concat_tables(self._waiting)
            self._writer = self._writer or self._new(self._file, table.schema)
            self._writer(table)
            self._waiting = []
            self._rows = self.waiting_bytes = 0

    def close(self) -> None:
        """Write what waits and the end of the file."""
        try:
            self.flush()
            if self._writer is not None:
                self._writer.close()
        finally:
            self._file.close()

    def abandon(self) -> None:
        """Close a file that is not going to be used."""
        if isinstance(self._writer, _Parquet):
            self._writer.abandon()
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        (self.close if kind is None else self.abandon)()


class _Parquet:
    """Groups of rows, with the least and greatest values of each page beside those of the group."""

    def __init__(self, file: Any, schema: pa.Schema) -> None:
        self._writer = import_module("pyarrow.parquet").ParquetWriter(file, schema, write_page_index=True)
        self.close = self._writer.close

    def __call__(self, table: pa.Table) -> None:
        self._writer.write_table(table, row_group_size=max(table.num_rows, 1))

    def abandon(self) -> None:
        """Write no end: pyarrow would when the writer goes, into a file that is closed, and report it as an ignored exception."""
        self._writer.is_open = False


class _Arrow:
    def __init__(self, file: Any, schema: pa.Schema) -> None:
        writer: Any = cast("Any", pa).ipc.new_file(file, schema)
        self.close, self._write = writer.close, writer.write_table

    def __call__(self, table: pa.Table) -> None:
        self._write(table)


class _Text:
    """CSV, whose columns are known with the first table."""

    def __init__(self, file: Any, _: pa.Schema) -> None:
        self._file, self._writer = file, cast("Any", None)

    def __call__(self, table: pa.Table) -> None:
        plain = _for_text(table)
        self._writer = self._writer or import_module("pyarrow.csv").CSVWriter(self._file, plain.schema)
        self._writer.write_table(plain)

    def close(self) -> None:
        if self._writer is not None:
            self._writer.close()


def _maker(suffix: str) -> Any:
    match suffix:
        case ".parquet":
            return _Parquet
        case ".arrow":
            return _Arrow
        case ".csv":
            return _Text
        case _:
            raise ValueError(f"tables are written as .parquet, .arrow, .csv and .npz, not as {suffix}")


def _for_text(nested: pa.Table) -> pa.Table:
    """A table whose columns CSV has: structs flat, lists, maps and bytes as JSON."""
    types, table = import_module("pyarrow.types"), cast("Any", flat(nested))
    for place, column in enumerate(table.schema):
        if types.is_nested(column.type) or types.is_large_binary(column.type) or types.is_fixed_size_binary(column.type):
            texts = [None if each is None else json.dumps(each, default=plain) for each in table.column(column.name).to_pylist()]
            table = table.set_column(place, column.name, pa.array(texts, pa.large_string()))
        elif types.is_dictionary(column.type):
            table = table.set_column(place, column.name, table.column(column.name).cast(pa.large_string()))
    return table
