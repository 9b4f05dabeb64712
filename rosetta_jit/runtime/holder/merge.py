"""Adding values to a message that has some: what merging, copying and constructing from keywords share."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, assert_never, cast

from rosetta_jit.errors import EncodeError
from rosetta_jit.model.layout import UNKNOWN
from rosetta_jit.runtime.holder import arena, coerce, values
from rosetta_jit.runtime.holder.access import raw, view_of
from rosetta_jit.runtime.holder.dictionary import Dictionary
from rosetta_jit.runtime.holder.message import Message, make_present, writable
from rosetta_jit.runtime.holder.record import Blob, Child, Entry, Items, Numbers, Pairs, Record, Scalar, Text
from rosetta_jit.runtime.holder.sequence import store_row
from rosetta_jit.runtime.limits import MAX_DEPTH


def merge(message: Message, fields: Mapping[str, Any], depth: int = 0) -> None:
    """Set what raw values name: leaves and arrays of fixed length replace, other arrays are appended, maps take over pairs, messages merge.

    Of fields that cannot be absent, zero changes nothing: as in protobuf, it is not regarded as a value that was set.
    """
    if depth > MAX_DEPTH:
        raise EncodeError("nesting", "", f"messages contain each other more than {MAX_DEPTH} deep")
    for name, value in fields.items():
        if name == UNKNOWN and message.access_.record.unknown is not None:
            with message.lanes_:
                lanes, row = writable(message)
                values.append_unknown(message.access_.record.unknown, lanes, row, value)
            continue
        entry = message.access_.record.entries[name]
        if entry.presence is not None or not is_zero(value):
            _merge_field(message, entry, value, depth)


def is_zero(value: Any) -> bool:
    """Whether a raw value is zero or empty. Minus zero is not."""
    if isinstance(value, float):
        return not value and math.copysign(1, value) > 0
    return value == 0 if isinstance(value, int) else len(value) == 0


def _merge_field(message: Message, entry: Entry, value: Any, depth: int) -> None:
    node = entry.node
    match node:
        case Scalar() | Text() | Blob():
            message.access_.setters[entry.name](message, value)
        case Numbers() | Items() if node.length is not None:
            with message.lanes_:
                lanes, row = writable(message)
                values.write_entry(entry, lanes, row, value)
        case Numbers():
            append_numbers(message, node, value)
        case Items():
            _append(message, node, value)
        case Pairs():
            shown = Dictionary(view_of(message), entry)
            for key, each in value.items():
                shown[key] = each
        case Record() | Child():
            inner = message.access_.getters[entry.name](message)
            make_present(inner)
            merge(inner, value, depth + 1)
        case _:
            assert_never(node)


def append_numbers(message: Message, node: Numbers, elements: Iterable[Any]) -> None:
    """Add elements to an array of numbers: all, or none if one is wrong."""
    prepared = coerce.numbers(node.type, elements)
    with message.lanes_:
        lanes, row = writable(message)
        count = arena.span_of(lanes, node.span, row)[1]
        coerce.counted(count + prepared.size, node.length, node.maximum)
        start = arena.resize(lanes, node, row, count + prepared.size) + count
        lanes.arrays[node.lane][start : start + prepared.size] = prepared


def _append(message: Message, node: Items, elements: list[Any]) -> None:
    with message.lanes_:
        lanes, row = writable(message)
        count = arena.span_of(lanes, node.span, row)[1]
        coerce.counted(count + len(elements), node.length, node.maximum)
        start = arena.resize(lanes, node, row, count + len(elements)) + count
        for index, each in enumerate(elements):
            store_row(node.element, lanes, start + index, each)


def fill(message: Message, fields: Mapping[str, Any]) -> None:
    """Set fields of an empty message, as the keywords of a constructor give them.

    Raises
    ------
    ValueError
        If there is no such field, or a value is out of range.
    TypeError
        If a value is of another kind.
    """
    record = message.access_.record
    for name, value in fields.items():
        entry = record.entries.get(name)
        if entry is None:
            raise ValueError(f'Protocol message {type(message).__name__} has no "{name}" field.')
        if value is not None:
            _fill_field(message, entry, value)


def _fill_field(message: Message, entry: Entry, value: Any) -> None:
    match entry.node:
        case Record() | Child():
            if not isinstance(value, Message | Mapping):
                raise TypeError(
                    f"Parameter to initialize message field must be dict or instance of same class: got {type(value).__name__}."
                )
            inner = message.access_.getters[entry.name](message)
            make_present(inner)
            _fill_message(inner, value)
        case Items(_, _, Record()):
            shown: Any = message.access_.getters[entry.name](message)
            for each in _iterable(value):
                _fill_message(shown.add(), each)
        case Numbers() | Items():
            _merge_field(message, entry, list(_iterable(value)), 0)
        case Pairs():
            _merge_field(message, entry, raw(dict(value)), 0)
        case _:
            _merge_field(message, entry, value, 0)


def _fill_message(inner: Message, value: Any) -> None:
    if isinstance(value, Mapping):
        fill(inner, cast("Mapping[str, Any]", value))
    else:
        merge(inner, raw(value))


def _iterable(value: Any) -> Iterable[Any]:
    if not isinstance(value, Iterable):
        raise TypeError("must assign iterable")
    return cast("Iterable[Any]", value)
