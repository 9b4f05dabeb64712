"""Getters and setters: one closure a field, that knows its cell.

Absent values are zero in memory, so presence is asked only where a default is not, and of the cases of a union, which share their memory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache as cached
from typing import Any, assert_never, cast

import numpy as np

from rosetta_jit.errors import EncodeError
from rosetta_jit.model.limits import MAX_INITIAL_BYTES
from rosetta_jit.runtime.holder import arena, coerce, grid, undo, values
from rosetta_jit.runtime.holder.message import Family, Getter, Message, Setter, View, beside, check_readable, element, place, writable
from rosetta_jit.runtime.holder.record import Bit, Blob, Child, Entry, Items, Numbers, Pairs, Record, Scalar, Text
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_DEPTH

Read = Callable[[Message, "Lanes", int], Any]
"""What reads a field of a message that has been found in a row of lanes."""


def getter(entry: Entry, family: Family) -> Getter:
    """The function that reads a field of a message."""
    node = entry.node
    match node:
        case Items() if not node.shape:
            sequence = family.sequence
            return lambda message: sequence(view_of(message), entry)
        case Scalar() | Text() | Blob() | Numbers() | Items():
            return _consistent(_or_default(_leaf(entry, node, family), entry))
        case Pairs():
            mapping = family.mapping
            return lambda message: mapping(view_of(message), entry)
        case Record():
            return lambda message: _beside(message, node, family)
        case Child():
            return lambda message: element(_new_view(family, node.record), view_of(message), family.access(node.record), entry, 0)
        case _:
            assert_never(node)


def _beside(message: Message, record: Record, family: Family) -> View:
    check_readable(message)
    return beside(_new_view(family, record), message, family.access(record))


def _new_view(family: Family, record: Record) -> View:
    cls = family.view_class(record.struct)
    return cls.__new__(cls)


def view_of(message: Message) -> View:
    """A view of a message, which the message can keep: it does not lead back to it."""
    check_readable(message)
    access = message.access_
    made = type(message) if isinstance(message, View) else access.family.view_class(access.record.struct)
    return beside(made.__new__(made), message, access)


def _consistent(read: Getter) -> Getter:
    """A getter that takes several steps, between which another thread may decode."""
    return lambda message: message.lanes_.consistent(read, message)


def _or_default(read: Read, entry: Entry) -> Getter:
    presence, default = entry.presence, entry.default
    is_guarded = presence is not None and (bool(default) or not isinstance(presence, Bit))

    def get(message: Message) -> Any:
        return read(message, *place(message))

    def get_or_default(message: Message) -> Any:
        lanes, row = place(message)
        return read(message, lanes, row) if arena.present(lanes, presence, row) else default

    return get_or_default if is_guarded else get


def _leaf(entry: Entry, node: values.Leaf, family: Family) -> Read:
    match node:
        case Scalar():
            return _scalar(node)
        case Text():
            return lambda _, lanes, row: coerce.decoded(node.type, arena.content(lanes, node.span, node.lane, row))
        case Blob():
            return _blob(node)
        case Numbers():
            return _numbers(entry, node, family)
        case Items():
            return lambda _, lanes, row: grid.view(node, lanes, row)


def _scalar(node: Scalar) -> Read:
    key, step, index = node.cell.key, node.cell.step, node.cell.index
    return lambda _, lanes, row: lanes.cells[key][row * step + index]


def _blob(node: Blob) -> Read:
    span, lane = node.span, node.lane
    absent = bytes(node.length) if node.length and node.length <= MAX_INITIAL_BYTES else b""
    return lambda _, lanes, row: bytes(arena.content(lanes, span, lane, row)) or absent


def _numbers(entry: Entry, node: Numbers, family: Family) -> Read:
    lane = node.lane
    absent = grid.zeros(node.type, (node.length,)).view(family.array_type) if node.length else None

    def read(_: Message, lanes: Lanes, row: int) -> Any:
        start, count = arena.span_of(lanes, node.span, row)
        return lanes.arrays[lane][start : start + count] if count or absent is None else absent

    def read_owned(message: Message, lanes: Lanes, row: int) -> Any:
        array = read(message, lanes, row)
        array.owner_ = message, entry
        return array

    return read if family.array_type is np.ndarray else read_owned


def setter(entry: Entry, family: Family) -> Setter:
    """The function that assigns to a field of a message."""
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


def assigner(entry: Entry) -> Setter:
    """The function that assigns to a field, also where the manners do not let people do so."""
    node = entry.node
    is_leaf = isinstance(node, Scalar | Text | Blob | Numbers) or (isinstance(node, Items) and bool(node.shape))
    return _leaf_setter(entry, cast("values.Leaf", node)) if is_leaf else _whole_setter(entry)


def _leaf_setter(entry: Entry, node: values.Leaf) -> Setter:
    presence = entry.presence

    def set_(message: Message, value: Any) -> None:
        prepared = values.prepare(node, value)
        with message.lanes_:
            lanes, row = writable(message)
            arena.mark(lanes, presence, row)
            values.put(node, lanes, row, prepared)

    return set_


def _whole_setter(entry: Entry) -> Setter:
    """Assignment of plain values, or of another message, to what is made of parts. What is refused leaves all as it was."""
    within = cached(lambda: undo.lanes_within(entry.node))

    def set_(message: Message, value: Any) -> None:
        plain = raw(value)
        with message.lanes_:
            before = undo.saved(message, within())
            try:
                lanes, row = writable(message)
                arena.clear(lanes, entry, row)
                values.write_entry(entry, lanes, row, plain)
            except BaseException:
                undo.restore(message.lanes_, before)
                raise

    return set_


def _refuse(kind: str, entry: Entry) -> Setter:
    def set_(message: Message, value: Any) -> None:  # noqa: ARG001  it is refused whatever it is
        raise AttributeError(f'Assignment not allowed to {kind} field "{entry.name}" in protocol message object.')

    return set_


def raw(value: Any, depth: int = 0) -> Any:
    """Values in the form that a field takes, apart from any lanes: messages become dicts, what can be iterated a list."""
    if depth > 2 * MAX_DEPTH:
        raise EncodeError("nesting", "", f"values contain each other more than {2 * MAX_DEPTH} deep")
    match value:
        case Message():
            return value.lanes_.consistent(_raw_message, value)
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
