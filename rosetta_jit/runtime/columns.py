"""Columns: one field of every row of a lane, as numpy sees it.

A number is a strided array. An array of anything is `Ragged`: the column of its elements' lane, and where each row's elements lie in it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, assert_never, cast

import numpy as np

from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import String
from rosetta_jit.runtime.batch_parts import chosen_rows
from rosetta_jit.runtime.cells import dtype_of
from rosetta_jit.runtime.holder import coerce
from rosetta_jit.runtime.holder.message import Message, place
from rosetta_jit.runtime.holder.paths import entries_to
from rosetta_jit.runtime.holder.record import Bit, Blob, Case, Cell, Child, Items, Node, Numbers, Pairs, Presence, Record, Scalar, Text
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_TEXT_ITEMS
from rosetta_jit.runtime.rows import elements
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray


_OCTETS, _CODE_UNITS = String("octets"), String("utf-16")


@dataclass(frozen=True, slots=True, eq=False)
class Origin:
    """Where a column is from: what makes an array of Arrow's of a batch's column, and the column's path there."""

    array: Callable[[str], Any]
    path: str


class Columns(dict[str, Any]):
    """The columns of a message, by the names of its fields: ``batch.header.stamp.secs``, or ``batch.header["stamp"]["secs"]``.

    A field that is named as something that dictionaries have, ``values``, is there by its name in brackets alone. All of them together
    are an array of structs for those that take Arrow's: ``pl.Series(batch.header)``, ``pa.table(batch.header)``.
    """

    __slots__ = ("__origin",)  # two underscores: no field of a message is called so

    def come_from(self, origin: Origin) -> None:
        """Say where these columns are from, and those in them."""
        self.__origin = origin
        for name, each in self.items():
            if isinstance(each, Columns):
                each.come_from(Origin(origin.array, f"{origin.path}.{name}"))
            elif isinstance(each, Ragged):
                self[name] = replace(each, origin=Origin(origin.array, f"{origin.path}.{name}"))

    def __arrow_c_array__(self, requested_schema: object = None) -> tuple[object, object]:
        """An array of structs, of the types of `Batch.to_arrow`."""
        return _arrow(getattr(self, "_Columns__origin", None), requested_schema)

    def __reduce__(self) -> tuple[Any, ...]:
        return Columns, (dict(self),)

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"there is no column {name!r} among {', '.join(self)}", name=name, obj=self) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]


@dataclass(frozen=True, slots=True, eq=False)
class Ragged:
    """An array of arrays of different lengths, none of them copied.

    Attributes
    ----------
    values : ndarray, Ragged or Columns
        All elements of the lane, those of other rows included.
    starts, counts : ndarray of int64, shape (n,)
        Where the elements of each row begin, and how many they are.
    kind : str
        ``"array"``, ``"text"`` (values are UTF-8 bytes, or UTF-16 code units) or ``"bytes"``.
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

        what = {"array": "arrays", "text": "texts", "bytes": "byte strings"}[self.kind]
        shown = ", ".join(brief(self[row]) for row in range(min(len(self), MAX_TEXT_ITEMS)))
        return f"<Ragged of {len(self)} {what}: {shown}{', …' if len(self) > MAX_TEXT_ITEMS else ''}>"

    def __getitem__(self, index: Any) -> Any:
        """One row: an array, a str or bytes. Of a slice, a mask or an array of numbers, the column of those rows."""
        if not isinstance(index, int | np.integer):
            rows = chosen_rows(index, len(self)).at
            return Ragged(self.values, self.starts[rows], self.counts[rows], self.kind, self.source)
        start, count = int(self.starts[index]), int(self.counts[index])
        if count < 0 and self.source is not None:
            data: Any = self.source[start : start + ~count]
        else:
            data = _part(self.values, start, count)
        match self.kind:
            case "text":
                return coerce.decoded(_OCTETS if self.values.dtype == np.uint8 else _CODE_UNITS, memoryview(data).cast("B"))
            case "bytes":
                return bytes(data)
            case _:
                return data

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
        return Ragged(values.values, values.starts[at], values.counts[at], values.kind, values.source)

    def __arrow_c_array__(self, requested_schema: object = None) -> tuple[object, object]:
        """An array of texts, bytes or lists: of a column of a whole batch of the types of `Batch.to_arrow`."""
        if self.origin is not None:
            return _arrow(self.origin, requested_schema)
        from rosetta_jit.runtime.arrow.column import values_array

        return values_array(self.to_list()).__arrow_c_array__(requested_schema)

    def __reduce__(self) -> tuple[Any, ...]:
        return Ragged, (self.values, self.starts, self.counts, self.kind, self.source)

    def __dlpack__(self, **options: Any) -> Any:
        """`to_numpy` for whoever reads DLPack: ``torch.from_dlpack(batch.angles)``. Columns of numbers are numpy's, and have this."""
        return self.to_numpy().__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        return 1, 0  # the processor's memory

    def to_list(self) -> list[Any]:
        """Python's own values, row by row."""
        return [listed(self[index]) for index in range(len(self))]


def _arrow(origin: Origin | None, requested_schema: object) -> tuple[object, object]:
    """Arrow's array of a column of a whole batch; TypeError for others."""
    if origin is None:
        raise TypeError("Arrow takes columns of a whole batch, and these are of elements, or of one message: use `to_arrow` of the batch")
    return origin.array(origin.path).__arrow_c_array__(requested_schema)


def of_batch(found: Any, origin: Origin) -> Any:
    """A column of a whole batch, which knows where it is from."""
    if isinstance(found, Columns):
        found.come_from(origin)
    return replace(found, origin=origin) if isinstance(found, Ragged) else found


def _part(values: Any, start: int, count: int) -> Any:
    match values:
        case Ragged():
            return Ragged(
                values.values, values.starts[start : start + count], values.counts[start : start + count], values.kind, values.source
            )
        case dict():
            return Columns((name, _part(each, start, count)) for name, each in cast("dict[str, Any]", values).items())
        case _:
            return values[start : start + count]


def listed(value: Any) -> Any:
    """A column, or a value in one, as Python's own values."""
    match value:
        case Ragged():
            return value.to_list()
        case np.ndarray():
            return value.tolist()  # pyright: ignore[reportUnknownMemberType]
        case dict():
            return {name: listed(each) for name, each in value.items()}  # pyright: ignore[reportUnknownVariableType]
        case _:
            return value


def cells(lanes: Lanes, cell: Cell, scalar: str, rows: int, *, behind: int = 0) -> NDArray[Any]:
    """A cell of the first rows of a lane, strided; ``behind`` counts cells to the right."""
    dtype = dtype_of(scalar)
    buffer = lanes.buffers[cell.lane]
    return np.ndarray((rows,), dtype, buffer.data, (cell.index + behind) * dtype.itemsize, (cell.step * dtype.itemsize,))


def column(node: Node, lanes: Lanes, rows: int, path: list[str]) -> Any:
    """The column of a node, or of a field inside it that a path names.

    Raises
    ------
    KeyError
        If there is no such field.
    TypeError
        If messages contain each other without bound there: those have no columns.
    """
    match node:
        case Scalar(cell, type_):
            return cells(lanes, cell, scalar_of(type_), rows)
        case Text(span, lane, _) | Blob(span, lane):
            kind = "text" if isinstance(node, Text) else "bytes"
            starts, counts = _spans(lanes, span, rows)
            borrowed = lanes.source[0]
            source = None if borrowed is None else memoryview(borrowed).cast("B")
            return Ragged(_elements(lanes, lane), starts, counts, kind, source)
        case Numbers(span, lane):
            return Ragged(_elements(lanes, lane), *_spans(lanes, span, rows))
        case Items(span, lane, element):
            return Ragged(column(element, lanes, lanes.used(lane), path), *_spans(lanes, span, rows))
        case Pairs(span, lane, _, key, value):
            used = lanes.used(lane)
            pairs = Columns(key=column(key, lanes, used, []), value=column(value.node, lanes, used, path))
            return Ragged(pairs, *_spans(lanes, span, rows))
        case Record():
            if lanes.plan.layout.lanes[node.lane].links is not None and node.lane:
                raise TypeError(f"messages of {node.struct} contain each other: read them one by one")
            if path:
                return column(node.entries[path[0]].node, lanes, rows, path[1:])
            return Columns((name, column(entry.node, lanes, rows, [])) for name, entry in node.entries.items())
        case Child():
            raise TypeError(f"messages of {node.record.struct} contain each other: read them one by one")
        case _:
            assert_never(node)


def column_of(message: Message, path: str) -> Any:
    """The column of an array of structs, or whatever else a path names, of one message."""
    lanes, row = place(message)
    entries_to(message.access_.record, path)
    first, *rest = path.split(".")
    return _at(column(message.access_.record.entries[first].node, lanes, row + 1, rest), row)


def _at(found: Any, row: int) -> Any:
    match found:
        case dict():
            return Columns((name, _at(each, row)) for name, each in cast("dict[str, Any]", found).items())
        case _:
            return found[row]


def presence_mask(presence: Presence | None, lanes: Lanes, rows: int) -> NDArray[np.bool_]:
    """Which rows have a field."""
    match presence:
        case None:
            return np.ones(rows, np.bool_)
        case Bit(cell, mask):
            return cells(lanes, cell, "u64", rows) & np.uint64(mask) != 0
        case Case(cell, number):
            return cells(lanes, cell, "i64", rows) == number
        case _:
            assert_never(presence)


def _elements(lanes: Lanes, lane: int) -> NDArray[Any]:
    return lanes.arrays[lane][: lanes.used(lane)].view(np.ndarray)


def _spans(lanes: Lanes, span: Cell, rows: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Where the elements of each row lie: read-only, because accessors and kernels go by it."""
    starts, counts = cells(lanes, span, "i64", rows), cells(lanes, span, "i64", rows, behind=1)
    starts.flags.writeable = counts.flags.writeable = False
    return starts, counts
