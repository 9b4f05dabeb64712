"""numpy's archives of tables that come one after another, so that no more than one is in memory.

How many rows an array has stands before them: so the arrays of each column wait in a temporary file until the last table has come.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from importlib import import_module
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Any, BinaryIO
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np

from rosetta_jit.runtime.arrow.tables import flat
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from pathlib import Path

    import pyarrow as pa
    from numpy.typing import NDArray


@dataclass(slots=True)
class _Column:
    """Arrays that become one: those of each table, in a file."""

    file: BinaryIO
    dtypes: list[np.dtype[Any]] = field(default_factory=list["np.dtype[Any]"])
    rows: int = 0
    tail: tuple[int, ...] = ()
    last: int = 0

    def add(self, array: NDArray[Any]) -> None:
        """The array of another table."""
        np.save(self.file, array, allow_pickle=False)
        self.dtypes.append(array.dtype)
        self.rows, self.tail = self.rows + len(array), array.shape[1:]

    def add_offsets(self, offsets: NDArray[np.int64]) -> None:
        """Offsets of another table, which go on where those before end."""
        self.add(offsets if not self.dtypes else offsets[1:] + self.last)
        self.last += int(offsets[-1])

    def write(self, file: Any) -> None:
        """All as one array of numpy's format; texts take as much room as the longest one."""
        dtype = np.result_type(*self.dtypes)
        header = {"descr": np.lib.format.dtype_to_descr(dtype), "fortran_order": False, "shape": (self.rows, *self.tail)}
        np.lib.format.write_array_header_1_0(file, header)
        self.file.seek(0)
        for _ in self.dtypes:
            file.write(np.load(self.file, allow_pickle=False).astype(dtype).tobytes())


def write_archive(tables: Iterable[pa.Table], path: Path) -> None:
    """An array a column, as `rosetta-jit decode --npz` writes them: the elements of lists end to end, beside ``NAME.offsets``."""
    columns: dict[str, _Column] = {}
    try:
        for nested in tables:
            table: Any = flat(nested)
            for name in table.schema.names:
                for key, array in _arrays(name, table.column(name).combine_chunks()).items():
                    if key not in columns:
                        columns[key] = _Column(TemporaryFile())  # noqa: SIM115 - closed below, with all others
                    (columns[key].add if key == name else columns[key].add_offsets)(array)
        with ZipFile(path, "w", ZIP_DEFLATED) as archive:
            for key, column in columns.items():
                with archive.open(f"{key}.npy", "w", force_zip64=True) as file:
                    column.write(file)
    finally:
        for column in columns.values():
            column.file.close()


def plain(value: object) -> object:
    """What JSON has for a value that it does not know."""
    return value.hex() if isinstance(value, bytes) else str(value)


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
    return {name: np.array([json.dumps(each, default=plain) for each in column.to_pylist()])}


def _numbers(column: Any) -> Any:
    """A column as an array: texts as texts of numpy, bytes in hexadecimal digits."""
    found = column.to_numpy(zero_copy_only=False)
    return found if found.dtype != object else np.array([plain(each) if isinstance(each, bytes) else str(each) for each in found], np.str_)
