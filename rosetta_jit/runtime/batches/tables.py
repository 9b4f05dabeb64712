"""Tables: what a batch is for whoever reads Arrow or pandas."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import DecodeError
from rosetta_jit.kernel.state import VALID
from rosetta_jit.runtime.batches.columns import WithColumns
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.lanes import Lanes

if TYPE_CHECKING:
    import numpy as np
    import pyarrow as pa
    from numpy.typing import NDArray

    from rosetta_jit.runtime.arrow.arrays import Form, Octets
    from rosetta_jit.runtime.arrow.times import Unit
    from rosetta_jit.runtime.memory_for_arrow import Handed


class WithTables(WithColumns):
    """What a batch can do by pyarrow, which is imported where it is needed."""

    __slots__ = ()
    if TYPE_CHECKING:  # a batch has them
        _family: HolderFamily
        _handed: Handed | None
        errors: dict[int, DecodeError]
        lanes: Lanes

        def __len__(self) -> int: ...
        @property
        def kept(self) -> NDArray[np.int64]: ...

    def to_arrow(
        self,
        columns: Sequence[str] | None = None,
        *,
        flatten: bool = False,
        octets: Octets = "string",
        copy: bool = True,
        times: Iterable[str] | Mapping[str, Unit] = (),
        errors: str | None = None,
    ) -> pa.Table:
        """The messages as a `pyarrow.Table`, of exactly the types that docs/columns.md lists.

        Parameters
        ----------
        columns
            The fields to take, with dots those of nested messages; all by default.
        flatten
            Whether each field of a nested message is a column of its own, named with dots.
        octets
            What becomes of strings that promise nothing about their bytes: text, which they must be then, or bytes.
        copy
            Whether the table has all memory of its own. Otherwise arrays of numbers and bytes that lie together in the lanes are shown
            there: they change with the next decode into the batch.
        times
            Fields that are moments, and become timestamps: structs of seconds and a part of one, and integers; in ns, or in the unit
            that a mapping gives, ``{"utime": "us"}``.
        errors
            The name of a further column, which says why a message could not be decoded, and is null where it could.

        Raises
        ------
        ImportError
            If pyarrow is not installed.
        KeyError
            If there is no such field.
        TypeError
            If messages contain each other: leave that field out. If what is to be a moment is none. If ``columns`` is one name.
        ValueError
            If an option has no such value, or ``errors`` is the name of a column.
        EncodeError
            If a string is no text that UTF-8 can carry, or a moment too far for a timestamp, or between two.
        InvalidHolder
            If the last decode into the batch failed.
        """
        from rosetta_jit.runtime.arrow import arrays, tables

        table = tables.table(self._record_batch(columns, arrays.Form.of(octets, copy, times, self._handed)))
        table = tables.flat(table) if flatten else table
        return table if errors is None else tables.with_errors(table, errors, self.errors, self.kept.tolist())

    def to_pandas(
        self,
        columns: Sequence[str] | None = None,
        *,
        flatten: bool = False,
        octets: Octets = "string",
        times: Iterable[str] | Mapping[str, Unit] = (),
        errors: str | None = None,
        **options: Any,
    ) -> Any:
        """The table of `to_arrow` as a `pandas.DataFrame`; ``options`` are those of `pyarrow.Table.to_pandas`."""
        return self.to_arrow(columns, flatten=flatten, octets=octets, times=times, errors=errors).to_pandas(**options)

    def _record_batch(self, columns: Sequence[str] | None, form: Form) -> pa.RecordBatch:
        if isinstance(columns, str):
            raise TypeError(f"columns is a list of names: columns=[{columns!r}]")
        names = list(self._family.tree.root.entries) if columns is None else list(columns)
        return self.lanes.consistent(lambda taken: self._taken(taken, form), names)

    def _taken(self, names: list[str], form: Form) -> pa.RecordBatch:
        from rosetta_jit.runtime.arrow.tables import record_batch

        self._check()
        return record_batch(self._family.tree.root, self.lanes, len(self), names, form)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """The table of `to_arrow` for whoever reads Arrow's stream interface: pyarrow, polars, DuckDB, pandas' `from_arrow`."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def __arrow_c_array__(self, requested_schema: object = None) -> tuple[object, object]:
        """The same as one array of structs: `pyarrow.record_batch(batch)`."""
        from rosetta_jit.runtime.arrow.arrays import Form

        return self._record_batch(None, Form()).__arrow_c_array__(requested_schema)

    def __array__(self, dtype: object = None, copy: bool | None = None) -> NDArray[np.object_]:
        """The rows of ``to_arrow(flatten=True)``, a record of Python's own values each: what `pandas.DataFrame(batch)` takes.

        Raises
        ------
        TypeError
            If another type than ``object`` is asked for.
        """
        from rosetta_jit.runtime.arrow import records

        records.check_asked(dtype, copy=copy)
        return records.records(self.to_arrow())

    def _column_to_arrow(self, name: str) -> pa.Array:
        from rosetta_jit.runtime.arrow.column import column_array

        return self.lanes.consistent(lambda path: column_array(self._family.tree.root, self.lanes, len(self), path), name)

    def _check(self) -> None:
        """Raise what says why the messages cannot be read, if they cannot."""
        if not self.lanes.words[VALID]:
            raise self.lanes.invalid()
