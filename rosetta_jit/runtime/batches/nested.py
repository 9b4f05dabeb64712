"""Columns that are no arrays of numpy's: `Columns` of messages, and `Ragged` of arrays, texts and bytes. Neither copies.

Those that take Arrow's arrays get the types of `Batch.to_arrow`, pandas' constructor a row a message.
"""

from __future__ import annotations

from collections.abc import Callable, ItemsView, Iterable, Iterator, KeysView, Mapping, Sequence, ValuesView
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from rosetta_jit.runtime.batches.parts import chosen_rows
from rosetta_jit.runtime.limits import MAX_TEXT_ITEMS
from rosetta_jit.runtime.rows import elements
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Origin:
    """Where a column is from: what makes an array of Arrow's of a batch's column, what a table of several, and the column's path there."""

    array: Callable[[str], Any]
    table: Callable[[Sequence[str]], Any]
    path: str

    def within(self, name: str) -> Origin:
        """Of a field of the messages that the column has."""
        return replace(self, path=f"{self.path}.{name}")

    def fields(self, names: Iterable[str]) -> Any:
        """The fields of the messages that the column has, as a table."""
        return self.table([f"{self.path}.{name}" for name in names]).rename_columns([*names])


class Columns:
    """The columns of a message, by the names of its fields: ``batch.header.stamp.secs``, or ``batch.header["stamp"]["secs"]``.

    They are read as a dictionary is: ``keys``, ``values``, ``items``, ``get``, ``in``, iteration. A field of such a name is there in
    brackets alone. All of them together are an array of structs for those that take Arrow's, ``pl.Series(batch.header)``, and a table:
    ``pa.table(batch.header)``, ``pd.DataFrame(batch.header)``.
    """

    __slots__ = ("__columns", "__origin")  # two underscores: no field of a message is called so
    __columns: dict[str, Any]
    __origin: Origin | None

    def __init__(self, columns: Mapping[str, Any] | Iterable[tuple[str, Any]]) -> None:
        object.__setattr__(self, "_Columns__columns", dict(columns))
        object.__setattr__(self, "_Columns__origin", None)

    def come_from(self, origin: Origin) -> None:
        """Say where these columns are from, and those in them."""
        object.__setattr__(self, "_Columns__origin", origin)
        for name, each in self.items():
            self.__columns[name] = of_batch(each, origin.within(name))

    def __getitem__(self, name: str) -> Any:
        return self.__columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.__columns)

    def __len__(self) -> int:
        return len(self.__columns)

    def __contains__(self, name: object) -> bool:
        return name in self.__columns

    def keys(self) -> KeysView[str]:
        """The names of the fields."""
        return self.__columns.keys()

    def values(self) -> ValuesView[Any]:
        """The columns."""
        return self.__columns.values()

    def items(self) -> ItemsView[str, Any]:
        """Names and columns."""
        return self.__columns.items()

    def get(self, name: str, default: Any = None) -> Any:
        """The column of a name, or something else if there is none."""
        return self.__columns.get(name, default)

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_Columns__") and name in self.__columns:
            return self.__columns[name]
        raise AttributeError(f"there is no column {name!r} among {', '.join(self)}", name=name, obj=self)

    def __setattr__(self, name: str, value: object) -> None:
        if name not in self.__columns:
            raise AttributeError(f"there is no column {name!r} among {', '.join(self)}", name=name, obj=self)
        refuse_others(name, self.__columns[name], value)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Columns):
            raise TypeError("columns of messages are compared field by field")
        return NotImplemented

    __hash__ = None  # pyright: ignore[reportAssignmentType]  as they show what changes

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        from rosetta_jit.runtime.looks.brief import brief

        return brief(self.__columns)

    def __reduce__(self) -> tuple[Any, ...]:
        return Columns, (self.__columns,)

    def __arrow_c_array__(self, requested_schema: object = None) -> tuple[object, object]:
        """An array of structs: of columns of a whole batch of the types of `Batch.to_arrow`."""
        return _arrow(self, self.__origin, requested_schema)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """A table of the fields, null where the message is absent."""
        from rosetta_jit.runtime.arrow.column import table_of_structs

        table = table_of_structs(values_array(self)) if self.__origin is None else self.__origin.fields(self)
        return table.__arrow_c_stream__(requested_schema)

    def __array__(self, dtype: object = None, copy: bool | None = None) -> NDArray[np.object_]:
        """A record of each message, the fields of nested messages beside the others: what `pandas.DataFrame(batch.header)` takes."""
        from rosetta_jit.runtime.arrow import records

        records.check_asked(dtype, copy=copy)
        if self.__origin is not None:
            return records.records(self.__origin.fields(self))
        flat = dict(_flat(self))
        return records.of_values([*flat], [each.tolist() if isinstance(each, np.ndarray) else list(each) for each in flat.values()])


cast("Any", Mapping).register(Columns)  # not a subclass: pandas' constructor would ask it for no records


@dataclass(frozen=True, slots=True, eq=False)
class Ragged:
    """An array of arrays of different lengths, none of them copied.

    Where the elements are messages, their fields are attributes: ``batch.poses.position.x`` is ``batch.column("poses.position.x")``.

    Attributes
    ----------
    values : ndarray, Ragged or Columns
        All elements of the lane, those of other rows included.
    starts, counts : ndarray of int64, shape (n,)
        Where the elements of each row begin, and how many they are.
    kind : str
        ``"array"``, ``"map"`` (of columns ``key`` and ``value``), ``"text"`` (values are UTF-8 bytes, or UTF-16 code units) or ``"bytes"``.
    source : memoryview or None
        What borrowed rows, whose counts are negative (``~count``), refer to.
    origin : Origin or None
        Where a column of a whole batch is from: those that take Arrow's arrays get one.
    """

    values: Any
    starts: NDArray[np.int64]
    counts: NDArray[np.int64]
    kind: str = "array"
    source: memoryview | None = None
    origin: Origin | None = None

    def __len__(self) -> int:
        return len(self.starts)

    def __iter__(self) -> Iterator[Any]:
        return map(self.__getitem__, range(len(self)))

    def __repr__(self) -> str:
        from rosetta_jit.runtime.looks.brief import brief

        what = {"array": "arrays", "map": "maps", "text": "texts", "bytes": "byte strings"}[self.kind]
        shown = ", ".join(brief(self[row]) for row in range(min(len(self), MAX_TEXT_ITEMS)))
        return f"<Ragged of {len(self)} {what}: {shown}{', …' if len(self) > MAX_TEXT_ITEMS else ''}>"

    def __getitem__(self, index: Any) -> Any:
        """One row: an array, a str or bytes. Of a slice, a mask or an array of numbers, the column of those rows."""
        if not isinstance(index, int | np.integer) or isinstance(index, bool):
            if isinstance(index, tuple):
                raise TypeError("a row is chosen by one number, its elements by another: `column[1][2]`, or `column.to_numpy()[1, 2]`")
            rows = chosen_rows(index, len(self)).at
            return type(self)(self.values, self.starts[rows], self.counts[rows], self.kind, self.source)
        start, count = int(self.starts[index]), int(self.counts[index])
        if count < 0 and self.source is not None:
            return self.source[start : start + ~count]
        return _part(self.values, start, count)

    def __getattr__(self, name: str) -> Any:
        if isinstance(self.values, Columns) and name in self.values:
            found = self.values[name]
            origin = None if self.origin is None or self.kind == "map" else self.origin.within(name)
            return Ragged(found, self.starts, self.counts, origin=origin)
        raise AttributeError(f"a column of {self.kind}s has no {name!r}", name=name, obj=self)

    def __dir__(self) -> list[str]:
        return [*object.__dir__(self), *(self.values if isinstance(self.values, Columns) else ())]

    def __eq__(self, other: object) -> Any:
        if other is None:
            return NotImplemented
        raise TypeError("columns of arrays are compared row by row, or as arrays: `column.to_numpy()`, where rows have one length")

    __ne__ = __eq__
    __hash__ = None  # pyright: ignore[reportAssignmentType]  as it shows what changes

    @property
    def contiguous(self) -> bool:
        """Whether the rows' elements follow each other without gaps, in order."""
        return bool((self.starts[1:] == self.starts[:-1] + self.counts[:-1]).all() and (self.counts >= 0).all())

    @property
    def offsets(self) -> NDArray[np.int64]:
        """Where each row's elements begin if they are put together, and the end of the last: shape (n + 1,), as Arrow has it."""
        counts = np.where(self.counts < 0, ~self.counts, self.counts)
        return np.concatenate([np.zeros(1, np.int64), np.cumsum(counts)])

    def flat(self) -> NDArray[Any]:
        """The elements of all rows, one after the other; not copied if they already lie so.

        Raises
        ------
        TypeError
            If the elements are not numbers.
        """
        if not isinstance(self.values, np.ndarray):
            raise TypeError("elements that are no numbers cannot be put into one array")
        values = cast("NDArray[Any]", self.values)
        if self.contiguous:
            first = int(self.starts[0]) if len(self) else 0
            return values[first : first + int(self.counts.sum())]
        if self.source is not None:
            return np.concatenate([np.frombuffer(self._bytes(index), np.uint8) for index in range(len(self))])
        within = np.arange(int(self.counts.sum())) - np.repeat(self.offsets[:-1], self.counts)
        return values[np.repeat(self.starts, self.counts) + within]

    def _bytes(self, index: int) -> Any:
        start, count = int(self.starts[index]), int(self.counts[index])
        return self.source[start : start + ~count] if count < 0 and self.source is not None else self.values[start : start + count]

    def to_numpy(self) -> NDArray[Any]:
        """The elements as an array, one row a message, and one dimension more for each array within; not copied if they already lie so.

        Raises
        ------
        ValueError
            If the rows differ in length.
        """
        return self._matrix()

    def _matrix(self) -> NDArray[Any]:
        """`to_numpy`, of texts their bytes or code units."""
        if len(self) and (self.counts != self.counts[0]).any():
            raise ValueError("rows of different lengths are no matrix; use `values`, `starts` and `counts`, or `to_list`")
        width = self.offsets[1] if len(self) else 0
        if isinstance(self.values, Ragged):
            inner = self._inner(self.values).to_numpy()
            return inner.reshape(len(self), int(width), *inner.shape[1:])
        return self.flat().reshape(len(self), int(width))

    def _inner(self, values: Ragged) -> Ragged:
        """The arrays within the rows, one after the other."""
        at = elements(self.starts, self.counts, len(values)).at
        return type(values)(values.values, values.starts[at], values.counts[at], values.kind, values.source)

    def __arrow_c_array__(self, requested_schema: object = None) -> tuple[object, object]:
        """An array of texts, bytes or lists: of a column of a whole batch of the types of `Batch.to_arrow`."""
        return _arrow(self, self.origin, requested_schema)

    def _values_array(self) -> Any:
        """An array of Arrow's of the values that are shown."""
        from rosetta_jit.runtime.arrow.column import lists, maps

        make: Any = maps if self.kind == "map" else lists
        return make(self.offsets, values_array(_taken(self.values, elements(self.starts, self.counts, self._held()).at)))

    def _held(self) -> int:
        """How many elements there are, those of other rows included."""
        values = self.values
        while isinstance(values, Columns):
            values = next(iter(values.values()), ())
        return len(values)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.values, self.starts, self.counts, self.kind, self.source)

    def __dlpack__(self, **options: Any) -> Any:
        """`to_numpy` for whoever reads DLPack: ``torch.from_dlpack(batch.angles)``. Columns of numbers are numpy's, and have this."""
        return self._matrix().__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        return 1, 0  # the processor's memory

    def to_list(self) -> list[Any]:
        """Python's own values, row by row."""
        return [listed(self[index]) for index in range(len(self))]

    tolist = to_list  # as arrays of numpy have it, which the columns of numbers are


def _arrow(found: Columns | Ragged, origin: Origin | None, requested_schema: object) -> tuple[object, object]:
    """Arrow's array of a column."""
    array = values_array(found) if origin is None else origin.array(origin.path)
    return array.__arrow_c_array__(requested_schema)


def values_array(found: Any) -> Any:
    """Arrow's array of a column that is no whole batch's, by its values alone: enums are numbers, and what is absent is as it is shown."""
    from rosetta_jit.runtime.arrow import column

    match found:
        case Ragged():
            return found._values_array()  # noqa: SLF001  # pyright: ignore[reportPrivateUsage]
        case Columns():
            return column.structs({name: values_array(each) for name, each in found.items()})
        case np.ndarray():
            return column.numbers(cast("NDArray[Any]", found))
        case _:
            raise _of_one_message()


def _of_one_message() -> TypeError:
    return TypeError("these are the fields of one message, and no columns: use `to_dict` of the message")


def _taken(values: Any, at: Any) -> Any:
    """Some elements of a lane."""
    match values:
        case Ragged():
            return replace(values, starts=values.starts[at], counts=values.counts[at], origin=None)
        case Columns():
            return Columns((name, _taken(each, at)) for name, each in values.items())
        case _:
            return values[at]


def _flat(columns: Columns, before: str = "") -> Iterator[tuple[str, Any]]:
    """The columns of messages and of those within, named with dots."""
    for name, each in columns.items():
        match each:
            case Columns():
                yield from _flat(each, f"{before}{name}.")
            case np.ndarray() | Ragged():
                yield f"{before}{name}", each
            case _:
                raise _of_one_message()


def refuse_others(name: str, found: Any, value: object) -> None:
    """Let a column be assigned to its own place, as ``batch.header.seq += 1`` does at its end; AttributeError says how else to write."""
    is_same = isinstance(value, np.ndarray) and isinstance(found, np.ndarray)
    if not is_same or cast("Any", value).__array_interface__ != cast("Any", found).__array_interface__:
        raise AttributeError(f"a column is written into: `.{name}[:] = …`, if it is one of numbers")


def of_batch(found: Any, origin: Origin) -> Any:
    """A column of a whole batch, which knows where it is from."""
    if isinstance(found, Columns):
        found.come_from(origin)
    return replace(found, origin=origin) if isinstance(found, Ragged) else found


def _part(values: Any, start: int, count: int) -> Any:
    match values:
        case Ragged():
            return values[start : start + count]
        case Columns():
            return Columns((name, _part(each, start, count)) for name, each in values.items())
        case _:
            return values[start : start + count]


def listed(value: Any) -> Any:
    """A column, or a value in one, as Python's own values."""
    match value:
        case Ragged():
            return value.to_list()
        case np.ndarray():
            return value.tolist()  # pyright: ignore[reportUnknownMemberType]
        case Columns():
            return {name: listed(each) for name, each in value.items()}
        case _:
            return value
