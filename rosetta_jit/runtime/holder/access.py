"""Getters and setters: one closure a field, that knows its cell. What a property of a holder runs.

A getter reads where the message already is (`Message.lanes_`, ``row_``); views look for their row before. Absent values are zero in memory,
so presence is asked only where a default is not, and of the cases of a union, which share their memory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Protocol, assert_never, cast

import numpy as np

from rosetta_jit.errors import EncodeError
from rosetta_jit.kernel.state import VALID
from rosetta_jit.model.births import MAX_BORN_BYTES
from rosetta_jit.runtime.holder import arena, coerce, grid, values
from rosetta_jit.runtime.holder.message import Message, View, bind, place, writable
from rosetta_jit.runtime.holder.record import Bit, Blob, Child, Items, Numbers, Pairs, Record, Scalar, Text

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder.record import Entry
    from rosetta_jit.runtime.lanes import Lanes

Getter = Callable[[Any], Any]
Setter = Callable[[Any, Any], None]


class Family(Protocol):
    """What the accessors of one holder class share; `rosetta_jit.runtime.holder.Family` is it."""

    @property
    def array_type(self) -> type[np.ndarray[Any, Any]]: ...
    @property
    def sequence(self) -> Callable[[Message, Entry], Any]: ...
    @property
    def mapping(self) -> Callable[[Message, Entry], Any]: ...
    @property
    def assigns_whole(self) -> bool: ...
    def access(self, record: Record) -> Access: ...
    def view_class(self, struct: str) -> type[View]: ...
    def empty_lanes(self) -> Lanes: ...


class Access:
    """How the fields of one record are read and written; each accessor is made when first used."""

    __slots__ = ("family", "getters", "record", "setters")

    def __init__(self, record: Record, family: Family) -> None:
        self.record = record
        self.family = family
        self.getters = _Made(lambda name: getter(record.entries[name], family))
        self.setters = _Made(lambda name: setter(record.entries[name], family))

    def empty_lanes(self) -> Lanes:
        """Lanes of the same layout in which everything is absent."""
        return self.family.empty_lanes()


class _Made(dict[str, Any]):
    """A dict that makes what it lacks."""

    __slots__ = ("make",)

    def __init__(self, make: Callable[[str], Any]) -> None:
        self.make = make

    def __missing__(self, name: str) -> Any:
        self[name] = made = self.make(name)
        return made


def getter(entry: Entry, family: Family, *, first_row: bool = False) -> Getter:
    """What reads a field of a message; quicker where all messages are in the first row of their lanes, as holders are."""
    node = entry.node
    guarded = entry.presence is not None and (bool(entry.default) or not isinstance(entry.presence, Bit))
    match node:
        case Scalar():
            return _or_default(_scalar(node), entry) if guarded else _scalar(node, first_row=first_row)
        case Text():
            return _or_default(_text(node), entry) if guarded else _consistent(_text(node))
        case Blob():
            return _or_default(_blob(node), entry) if guarded else _consistent(_blob(node))
        case Numbers():
            return _numbers(entry, node, family, first_row=first_row)
        case Items() if node.shape:
            return _consistent(_grid(node))
        case Items():
            return lambda message: family.sequence(message, entry)
        case Pairs():
            return lambda message: family.mapping(message, entry)
        case Record() | Child():
            return _message(entry, node, family)
        case _:
            assert_never(node)


def _consistent(read: Getter) -> Getter:
    """A getter that takes several steps, between which another thread may decode."""
    return lambda message: message.home_.consistent(read, message)


def _or_default(get: Getter, entry: Entry) -> Getter:
    presence, default = entry.presence, entry.default

    def get_or_default(message: Message) -> Any:
        if arena.present(message.lanes_, presence, message.row_):
            return get(message)
        place(message)
        return default

    return _consistent(get_or_default)


def _scalar(node: Scalar, *, first_row: bool = False) -> Getter:
    key, step, index = node.cell.key, node.cell.step, node.cell.index

    def get(message: Message) -> Any:
        lanes = message.lanes_
        if lanes.words[VALID]:
            return lanes.cells[key][message.row_ * step + index]
        raise lanes.invalid()

    def get_first(message: Message) -> Any:
        lanes = message.lanes_
        if lanes.words[VALID]:
            return lanes.cells[key][index]
        raise lanes.invalid()

    return get_first if first_row else get


def _text(node: Text) -> Getter:
    span, lane, type_ = node.span, node.lane, node.type

    def get(message: Message) -> str:
        lanes = message.lanes_
        if lanes.words[VALID]:
            return coerce.decoded(type_, arena.content(lanes, span, lane, message.row_))
        raise lanes.invalid()

    return get


def _blob(node: Blob) -> Getter:
    span, lane = node.span, node.lane
    absent = bytes(node.length) if node.length and node.length <= MAX_BORN_BYTES else b""

    def get(message: Message) -> bytes:
        lanes = message.lanes_
        if lanes.words[VALID]:
            return bytes(arena.content(lanes, span, lane, message.row_)) or absent
        raise lanes.invalid()

    return get


def _numbers(entry: Entry, node: Numbers, family: Family, *, first_row: bool) -> Getter:
    lane, key, index = node.lane, node.span.key, node.span.index
    behind = index + 1
    absent = grid.zeros(node.type, (node.length,)).view(family.array_type) if node.length else None

    def get(message: Message) -> Any:
        lanes = message.lanes_
        if not lanes.words[VALID]:
            raise lanes.invalid()
        start, count = arena.span_of(lanes, node.span, message.row_)
        return lanes.arrays[lane][start : start + count] if count or absent is None else absent

    def get_first(message: Message) -> Any:
        lanes = message.lanes_
        if not lanes.words[VALID]:
            raise lanes.invalid()
        words = lanes.cells[key]
        start, count = words[index], words[behind]
        return lanes.arrays[lane][start : start + count] if count or absent is None else absent

    def get_owned(message: Message) -> Any:
        array = get(message)
        array.owner_ = message, entry
        return array

    def get_first_owned(message: Any) -> Any:
        lanes = message.lanes_
        if not lanes.words[VALID]:
            raise lanes.invalid()
        words = lanes.cells[key]
        start = words[index]
        array = lanes.arrays[lane][start : start + words[behind]]
        array.owner_ = message, entry
        return array

    if family.array_type is np.ndarray:
        return get_first if first_row else get
    return get_first_owned if first_row else get_owned


def _grid(node: Items) -> Getter:
    def get(message: Message) -> Any:
        lanes = message.lanes_
        if lanes.words[VALID]:
            return grid.view(node, lanes, message.row_)
        raise lanes.invalid()

    return get


def _message(entry: Entry, node: Record | Child, family: Family) -> Getter:
    record = node.record if isinstance(node, Child) else node
    through = entry if isinstance(node, Child) else None

    def get(message: Message) -> View:
        place(message)
        cls = family.view_class(record.struct)
        return bind(cls.__new__(cls), message, family.access(record), through)

    return get


def setter(entry: Entry, family: Family) -> Setter:
    """What assigns to a field of a message."""
    node = entry.node
    match node:
        case Scalar() | Text() | Blob():
            return _leaf_setter(entry, node)
        case Numbers():
            return _leaf_setter(entry, node) if family.assigns_whole else _refuse("map, or repeated", entry)
        case Items() if node.shape and family.assigns_whole:
            return _leaf_setter(entry, node)
        case Items() | Pairs():
            return _whole_setter(entry) if family.assigns_whole else _refuse("map, or repeated", entry)
        case Record() | Child():
            return _whole_setter(entry) if family.assigns_whole else _refuse("message", entry)
        case _:
            assert_never(node)


def _leaf_setter(entry: Entry, node: values.Leaf) -> Setter:
    presence = entry.presence

    def set_(message: Message, value: Any) -> None:
        prepared = values.prepare(node, value)
        with message.home_:
            lanes, row = writable(message)
            arena.mark(lanes, presence, row)
            values.put(node, lanes, row, prepared)

    return set_


def _whole_setter(entry: Entry) -> Setter:
    """Assignment of plain values, or of another message, to what is made of parts."""

    def set_(message: Message, value: Any) -> None:
        plain = raw(value)
        with message.home_:
            lanes, row = writable(message)
            arena.clear(lanes, entry, row)
            values.write_entry(entry, lanes, row, plain)

    return set_


def _refuse(kind: str, entry: Entry) -> Setter:
    def set_(message: Message, value: Any) -> None:  # noqa: ARG001  it is refused whatever it is
        raise AttributeError(f'Assignment not allowed to {kind} field "{entry.name}" in protocol message object.')

    return set_


def raw(value: Any, depth: int = 0) -> Any:
    """Values in the form that a field takes, apart from any lanes: messages become dicts, what can be iterated a list."""
    if depth > 2 * values.MAX_DEPTH:
        raise EncodeError("nesting", "", f"values contain each other more than {2 * values.MAX_DEPTH} deep")
    match value:
        case Message():
            return value.home_.consistent(_raw_message, value)
        case Mapping():
            return {key: raw(each, depth + 1) for key, each in cast("Mapping[Any, Any]", value).items()}
        case str() | bytes() | bytearray() | memoryview() | np.ndarray():
            return cast("Any", value)
        case Iterable():
            return [raw(each, depth + 1) for each in cast("Iterable[Any]", value)]
        case _:
            return value


def _raw_message(message: Message) -> dict[str, Any]:
    lanes, row = place(message)
    return values.read_record(message.access_.record, lanes, row, values.Form.RAW)
