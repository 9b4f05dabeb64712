"""Lanes as Arrow arrays: a node and some rows become one array, with numpy, without Python a message.

    Scalar    its own type; an enum a dictionary of its names      Text     large_string
    Numbers   large_list, or fixed_size_list                       Blob     large_binary, or fixed_size_binary
    Items     the same of any element                              Pairs    map
    Record    struct; a field that can be absent is nullable, and so is each case of a union. All else is not.

Offsets have 64 bits, except in maps, for which Arrow has none of that width.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, assert_never, cast, get_args

import numpy as np
import pyarrow as pa

from rosetta_jit.errors import EncodeError
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Enum, Float, Int
from rosetta_jit.runtime.arrow.texts import NoTextError, text_array
from rosetta_jit.runtime.arrow.times import Unit, time_array
from rosetta_jit.runtime.holder.record import Blob, Cell, Child, Entry, Items, Node, Numbers, Pairs, Record, Scalar, ScalarType, Text
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.rows import Rows, elements, fixed_elements, fixed_together, lent, offsets, picked, read, room_for, spans
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.runtime.memory_for_arrow import Handed
    from rosetta_jit.runtime.rows import Flags, Indices

    Arrow = pa.Array

Octets = Literal["string", "binary"]

MOST_PAIRS, MOST_COUNTED = (1 << 31) - 1, 1 << 10

NO_TEXT = (
    "value {number} of the column is no text that UTF-8 can carry, as Arrow's strings must; "
    '`to_arrow(octets="binary")` gives strings that promise no encoding as bytes'
)


@dataclass(frozen=True, slots=True)
class Form:
    """The form of the arrays.

    Attributes
    ----------
    octets
        What becomes of strings that promise nothing about their bytes.
    copies
        Whether the arrays have memory of their own; otherwise those of numbers and bytes show the lanes, where they lie together there.
    times
        The units of fields that become timestamps, by their names.
    handed
        Where the arrays are to have memory of their own: whether they may take that of the lanes.
    """

    octets: Octets = "string"
    copies: bool = True
    times: Mapping[str, Unit] = field(default_factory=dict[str, "Unit"])
    handed: Handed | None = None

    @classmethod
    def of(cls, octets: Octets, copies: bool, times: Iterable[str] | Mapping[str, Unit], handed: Handed | None = None) -> Form:
        """The form that a user describes.

        Raises
        ------
        ValueError
            If there is no such form of strings, or no such unit.
        TypeError
            If one name is given instead of several.
        """
        if octets not in get_args(Octets):
            raise ValueError(f'octets is "string" or "binary", not {octets!r}')
        if isinstance(times, str):
            raise TypeError(f"times is a list of names, or units by name: times=[{times!r}]")
        units = units_of(times)
        unknown = [each for each in units.values() if each not in get_args(Unit)]
        if unknown:
            raise ValueError(f'the unit of a time is "s", "ms", "us" or "ns", not {unknown[0]!r}')
        return cls(octets, copies, units, handed)


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """Rows of the lanes, the form that they take, and the path to them, for errors."""

    lanes: Lanes
    form: Form
    rows: Rows
    path: str = ""

    def at(self, rows: Rows, path: str) -> Place:
        return Place(self.lanes, self.form, rows, path)


def units_of(times: Iterable[str] | Mapping[str, Unit]) -> dict[str, Unit]:
    """The units of fields that become timestamps: ns where none is given."""
    match times:
        case Mapping():
            return dict(cast("Mapping[str, Unit]", times))
        case _:
            return dict.fromkeys(times, "ns")


def room(words: int) -> Indices:
    """Memory of Arrow's own allocator, which keeps what it has got: memory anew costs more than what is written there."""
    return np.frombuffer(cast("Any", pa.allocate_buffer(8 * words)), np.int64) if words else np.empty(0, np.int64)


def entry_array(entry: Entry, place: Place, *, nullable: bool) -> Arrow:
    """The array of a field of records, which is null where the field, or what is around it, is absent."""
    inner = place.at(place.rows.with_field(entry.presence, place.lanes), f"{place.path}.{entry.name}")
    return _array(entry.node, inner, _validity(inner.rows) if nullable else None)


def _name(place: Place) -> str:
    return place.path.replace("[]", "").lstrip(".")


def _validity(rows: Rows) -> pa.Buffer | None:
    return None if rows.live is None or rows.live.all() else _bits(rows.live)


def _bits(flags: NDArray[Any]) -> pa.Buffer:
    return pa.py_buffer(np.packbits(flags, bitorder="little"))


def _array(node: Node, place: Place, validity: pa.Buffer | None) -> Arrow:
    """The array of a node: one element a row."""
    unit = place.form.times.get(_name(place)) if place.form.times else None
    if unit is not None and not isinstance(node, Items):
        return time_array(node, place.lanes, place.rows, unit, validity, place.path)
    match node:
        case Scalar(cell, Enum(_, values) as type_) if values and place.rows.live is not None:
            numbers = read(place.lanes, cell, scalar_of(type_), place.rows)
            return _named(type_, np.where(place.rows.live, numbers, np.int32(values[0][1])), validity)
        case Scalar(cell, type_):
            return _scalars(type_, read(place.lanes, cell, scalar_of(type_), place.rows), validity)
        case Text():
            return _texts(node, place, validity)
        case Blob():
            return _blobs(node, place, validity)
        case Numbers():
            return _numbers(node, place, validity)
        case Items():
            return _items(node, place, validity)
        case Pairs():
            return _pairs(node, place, validity)
        case Record():
            return _struct(node, place, validity)
        case Child():
            raise _recursive(node.record, place)
        case _:
            assert_never(node)


def _scalars(type_: ScalarType, values: NDArray[Any], validity: pa.Buffer | None) -> Arrow:
    match type_:
        case Bool():
            return pa.Array.from_buffers(pa.bool_(), len(values), [validity, _bits(values)])
        case Int() | Float():
            return pa.Array.from_buffers(pa.from_numpy_dtype(values.dtype), len(values), [validity, pa.py_buffer(values)])
        case Enum():
            return _named(type_, values, validity)
        case _:
            assert_never(type_)


def _named(type_: Enum, values: NDArray[np.int32], validity: pa.Buffer | None) -> Arrow:
    """The numbers of an enum by name. One that has no name, as open enums allow, is written in digits."""
    names: dict[int, str] = {}
    for name, number in type_.values:
        names.setdefault(number, name)
    numbers, places = _distinct(values)
    every = [*names, *(number for number in numbers if number not in names)]
    code_of = {number: code for code, number in enumerate(every)}
    codes = np.array([code_of[number] for number in numbers], np.int32)[places]
    indices = pa.Array.from_buffers(pa.int32(), len(codes), [validity, pa.py_buffer(codes)])
    return pa.DictionaryArray.from_arrays(indices, _strings([names.get(each, str(each)) for each in every]))


def _strings(texts: Sequence[str]) -> Arrow:
    """A few texts. Unlike `pa.array`, this does not import pandas."""
    octets = [each.encode() for each in texts]
    ends = offsets(np.array([len(each) for each in octets], np.int64)).astype(np.int32)
    return pa.Array.from_buffers(pa.string(), len(texts), [None, pa.py_buffer(ends), pa.py_buffer(b"".join(octets))])


def _distinct(values: NDArray[np.int32]) -> tuple[list[int], NDArray[Any]]:
    """The numbers that there are, and which of them each value is. Few small ones need not be sorted."""
    low, high = (int(values.min()), int(values.max())) if len(values) else (0, 0)
    if high - low > len(values) + MOST_COUNTED:
        numbers, places = np.unique(values, return_inverse=True)
        return numbers.tolist(), places
    occurs = np.bincount(values - low, minlength=1) > 0
    numbers = np.flatnonzero(occurs)
    return (numbers + low).tolist(), (np.cumsum(occurs) - 1)[values - low]


def _texts(node: Text, place: Place, validity: pa.Buffer | None) -> Arrow:
    octets, starts, counts = lent(place.lanes, node.lane, *spans(place.lanes, node.span, place.rows))
    data = _elements(place, node.lane, octets, starts, counts, copies=True)
    if node.type.encoding == "octets" and place.form.octets == "binary":
        return pa.Array.from_buffers(pa.large_binary(), len(counts), [validity, pa.py_buffer(offsets(counts, room)), pa.py_buffer(data)])
    try:
        return text_array(node.type, data, offsets(counts, room), validity)
    except NoTextError as wrong:
        raise EncodeError("text", place.path, NO_TEXT.format(number=wrong.number)) from None


def _blobs(node: Blob, place: Place, validity: pa.Buffer | None) -> Arrow:
    octets, starts, counts = lent(place.lanes, node.lane, *spans(place.lanes, node.span, place.rows))
    data = _elements(place, node.lane, octets, starts, counts, copies=place.form.copies)
    if node.length is None:
        buffers = [validity, pa.py_buffer(offsets(counts, room)), pa.py_buffer(data)]
        return pa.Array.from_buffers(pa.large_binary(), len(counts), buffers)
    return pa.Array.from_buffers(pa.binary(node.length), len(counts), [validity, pa.py_buffer(_padded(data, counts, node.length))])


def _elements(place: Place, lane: int, values: NDArray[Any], starts: Indices, counts: Indices, *, copies: bool) -> NDArray[Any]:
    """The values of spans, one after the other: the arrays' own if copies are wanted."""
    return _own(place, lane, values, picked(values, starts, counts, room), copies=copies)


def _own(place: Place, lane: int, values: NDArray[Any], found: NDArray[Any], *, copies: bool) -> NDArray[Any]:
    """What was found among the values of a lane: the arrays' own if copies are wanted."""
    if not copies or not np.may_share_memory(found, values):
        return found
    if place.form.handed is not None and place.form.handed.takes(place.lanes, lane, found, room):
        return found
    own = room_for(found.size, found.dtype, room)
    own[:] = found
    return own


def _values(lanes: Lanes, lane: int) -> NDArray[Any]:
    return lanes.arrays[lane][: lanes.used(lane)].view(np.ndarray)


def _padded(data: NDArray[Any], counts: Indices, length: int) -> NDArray[Any]:
    """Arrays of fixed length one after the other: zeros for those that are not there."""
    there = counts == length
    if there.all():
        return data
    every = np.zeros((len(counts), length), data.dtype)
    every[there] = data[np.repeat(there, counts)].reshape(-1, length)
    return every.reshape(-1)


def _numbers(node: Numbers, place: Place, validity: pa.Buffer | None) -> Arrow:
    if node.length is not None and (whole := fixed_together(place.lanes, node.lane, node.span, node.length, place.rows)) is not None:
        every = _values(place.lanes, node.lane)
        values = _own(place, node.lane, every, every[whole], copies=place.form.copies)
        return _fixed(node.length, _scalars(node.type, values, None), place.rows.count, validity)
    starts, counts = spans(place.lanes, node.span, place.rows)
    values = _elements(place, node.lane, _values(place.lanes, node.lane), starts, counts, copies=place.form.copies)
    if node.length is not None:
        return _fixed(node.length, _scalars(node.type, _padded(values, counts, node.length), None), len(counts), validity)
    return _listed(counts, _scalars(node.type, values, None), validity)


def _items(node: Items, place: Place, validity: pa.Buffer | None) -> Arrow:
    starts, counts = spans(place.lanes, node.span, place.rows)
    path, used = f"{place.path}[]", place.lanes.used(node.lane)
    if node.length is not None:
        within = _array(node.element, place.at(fixed_elements(starts, counts, node.length, used, room), path), None)
        return _fixed(node.length, within, len(counts), validity)
    return _listed(counts, _array(node.element, place.at(elements(starts, counts, used, room), path), None), validity)


def _listed(counts: Indices, values: Arrow, validity: pa.Buffer | None) -> Arrow:
    type_ = pa.large_list(pa.field("item", values.type, nullable=False))
    return pa.Array.from_buffers(type_, len(counts), [validity, pa.py_buffer(offsets(counts, room))], children=[values])


def _fixed(length: int, values: Arrow, count: int, validity: pa.Buffer | None) -> Arrow:
    type_ = pa.list_(pa.field("item", values.type, nullable=False), length)
    return pa.Array.from_buffers(type_, count, [validity], children=[values])


def _pairs(node: Pairs, place: Place, validity: pa.Buffer | None) -> Arrow:
    """A map. Of equal keys in one row, the last counts."""
    starts, counts = spans(place.lanes, node.span, place.rows)
    inner = place.at(elements(starts, counts, place.lanes.used(node.lane), room), f"{place.path}[]")
    last = _last_of_equal(_array(node.key, inner, None), counts)
    if not last.all():
        kept = offsets(last.astype(np.int64))
        inner, counts = inner.at(inner.rows.only(last), inner.path), np.diff(kept[offsets(counts)])
    pair = _struct(node.record, inner, None)
    if inner.rows.count > MOST_PAIRS:
        raise EncodeError("count", place.path, f"{inner.rows.count} entries, and Arrow's maps have at most {MOST_PAIRS} in a column")
    places = offsets(counts).astype(np.int32)
    type_ = pa.map_(pair.type.field(0).type, pair.type.field(1))
    return pa.Array.from_buffers(type_, len(counts), [validity, pa.py_buffer(places)], children=[pair])


def _last_of_equal(keys: Arrow, counts: Indices) -> Flags:
    """Which keys come not again in the same row."""
    codes = np.asarray(keys.dictionary_encode().indices.to_numpy(zero_copy_only=False), np.int64)
    rows = np.repeat(np.arange(len(counts)), counts)
    _, behind = np.unique((rows * (len(codes) + 1) + codes)[::-1], return_index=True)
    last = np.zeros(len(codes), np.bool_)
    last[len(codes) - 1 - behind] = True
    return last


def _struct(record: Record, place: Place, validity: pa.Buffer | None) -> Arrow:
    lane = place.lanes.plan.layout.lanes[record.lane]
    if lane.links is not None and record.lane:
        raise _recursive(record, place)
    nullable = [entry.presence is not None for entry in record.entries.values()]
    place = place.at(reading_all(record, place.lanes, place.rows), place.path)
    arrays = [entry_array(entry, place, nullable=can_be) for entry, can_be in zip(record.entries.values(), nullable, strict=True)]
    fields = [pa.field(name, each.type, can_be) for name, each, can_be in zip(record.entries, arrays, nullable, strict=True)]
    return pa.Array.from_buffers(pa.struct(fields), place.rows.count, [validity], children=arrays)


def reading_all(record: Record, lanes: Lanes, rows: Rows) -> Rows:
    """Rows of which all of a record is going to be read."""
    return rows.reading(lanes, record.lane, record.start, record.end, _arrays_of_fixed_length(record))


def _arrays_of_fixed_length(record: Record) -> Iterator[tuple[Cell, int]]:
    """The spans of arrays in a record that each row has, and the length of each."""
    for each in record.entries.values():
        match each.node:
            case Numbers(span, _, _, int(length)) if each.presence is None:
                yield span, length
            case Record() if each.presence is None:
                yield from _arrays_of_fixed_length(each.node)
            case _:
                pass


def _recursive(record: Record, place: Place) -> TypeError:
    return TypeError(
        f"`{place.path.lstrip('.')}`: messages of {record.struct} contain each other, for which Arrow has no type; "
        "name the other columns, `to_arrow(columns=[...])`, and read this one message by message"
    )
