"""Plain Python values of a node of a holder, and back: the one reader and the one writer that copy, compare, print and pickle share.

A record is a dict of what is present; its names are those of the IDL. For a person enums are names and arrays are lists (`Form.PLAIN`);
between holders they stay numbers and numpy arrays (`Form.RAW`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sized
from enum import Enum as Enumeration
from typing import Any, assert_never, cast

from rosetta_jit.errors import EncodeError, ValuesError
from rosetta_jit.model.layout import UNKNOWN
from rosetta_jit.model.types import Enum
from rosetta_jit.runtime.holder import arena, coerce, grid
from rosetta_jit.runtime.holder.paths import no_such_field
from rosetta_jit.runtime.holder.record import Blob, Child, Entry, Items, Node, Numbers, Pairs, Record, Scalar, ScalarType, Text
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_DEPTH

Leaf = Scalar | Text | Blob | Numbers | Items
"""What is written at once. Of `Items`, those that have a shape."""


class Form(Enumeration):
    """For whom values are read."""

    PLAIN = "plain"
    RAW = "raw"


def read(node: Node, lanes: Lanes, row: int, form: Form, depth: int = 0) -> Any:
    """The value of a node.

    Raises
    ------
    EncodeError
        If messages contain each other more than `MAX_DEPTH` deep.
    """
    match node:
        case Scalar(cell, type_):
            value = lanes.cells[cell.key][row * cell.step + cell.index]
            return _named(type_, value) if form is Form.PLAIN else value
        case Text(span, lane, type_):
            return coerce.decoded(type_, arena.content(lanes, span, lane, row))
        case Blob(span, lane):
            return bytes(arena.content(lanes, span, lane, row))
        case Numbers(span, lane, type_):
            start, count = arena.span_of(lanes, span, row)
            array = lanes.arrays[lane][start : start + count]
            if form is Form.RAW:
                return array.copy()
            return [_named(type_, value) for value in array.tolist()] if isinstance(type_, Enum) else array.tolist()
        case Items() if node.shape and form is Form.RAW:
            return grid.view(node, lanes, row).copy()
        case Items(span, _, element):
            start, count = arena.span_of(lanes, span, row)
            return [read(element, lanes, each, form, depth + 1) for each in range(start, start + count)]
        case Pairs(span, _, _, key, value):
            start, count = arena.span_of(lanes, span, row)
            rows = range(start, start + count)
            return {read(key, lanes, each, form): read(value.node, lanes, each, form, depth + 1) for each in rows}
        case Record():
            return read_record(node, lanes, row, form, depth)
        case Child(span, _, record):
            start, count = arena.span_of(lanes, span, row)
            return read_record(record, lanes, start, form, depth) if count else {}
        case _:
            assert_never(node)


def read_record(record: Record, lanes: Lanes, row: int, form: Form, depth: int = 0) -> dict[str, Any]:
    """The fields of a record that are present; between holders also those that the schema does not know, as bytes."""
    if depth > MAX_DEPTH:
        raise EncodeError("nesting", "", f"messages contain each other more than {MAX_DEPTH} deep")
    found = {
        entry.name: read(entry.node, lanes, row, form, depth + 1)
        for entry in record.entries.values()
        if arena.present(lanes, entry.presence, row)
    }
    if form is Form.RAW and record.unknown is not None and arena.span_of(lanes, record.unknown.span, row)[1]:
        found[UNKNOWN] = bytes(arena.content(lanes, record.unknown.span, record.unknown.lane, row))
    return found


def _named(type_: ScalarType, value: Any) -> Any:
    """The name of an enum's number, where it has one."""
    if not isinstance(type_, Enum):
        return value
    return next((name for name, number in type_.values if number == value), value)


def write(node: Node, lanes: Lanes, row: int, value: Any, path: str = "", *, depth: int = 0) -> None:
    """Make a value that of a node, which is empty. Records merge, and an array of fixed length that is given none keeps its initial value.

    Raises
    ------
    ValuesError
        If the node's type cannot take the value.
    """
    match node:
        case Scalar() | Text():
            _store(node, lanes, row, value, path)
        case Blob() | Numbers() | Items() if node.length and isinstance(value, Sized) and not len(value):
            pass
        case Blob() | Numbers():
            _store(node, lanes, row, value, path)
        case Items() if node.shape:
            _store(node, lanes, row, value, path)
        case Items():
            values = _sequence(value, path)
            _check_length(len(values), node, path)
            start = arena.resize(lanes, node, row, len(values))
            for index, each in enumerate(values):
                write(node.element, lanes, start + index, each, f"{path}[{index}]", depth=depth + 1)
        case Pairs(_, _, _, key, entry):
            values = _mapping(value, path)
            start = arena.resize(lanes, node, row, len(values))
            for index, (each, of_key) in enumerate(values.items()):
                write(key, lanes, start + index, each, f"{path}[{each!r:.40}]")
                write(entry.node, lanes, start + index, of_key, f"{path}[{each!r:.40}]", depth=depth + 1)
        case Record():
            write_record(node, lanes, row, value, path, depth=depth)
        case Child(span, _, record):
            start, count = arena.span_of(lanes, span, row)
            write_record(record, lanes, start if count else arena.resize(lanes, node, row, 1), value, path, depth=depth)
        case _:
            assert_never(node)


def write_record(record: Record, lanes: Lanes, row: int, values: Any, path: str = "", *, depth: int = 0) -> None:
    """Set the fields that a mapping names; the others stay as they are."""
    if depth > MAX_DEPTH:
        raise ValuesError(path, f"messages contain each other more than {MAX_DEPTH} deep")
    for name, value in _mapping(values, path).items():
        if name == UNKNOWN and record.unknown is not None:
            append_unknown(record.unknown, lanes, row, value)
            continue
        entry = record.entries.get(name)
        if entry is None:
            raise ValuesError(f"{path}.{name}", no_such_field(record, name))
        write_entry(entry, lanes, row, value, path, depth=depth)


def append_unknown(node: Blob, lanes: Lanes, row: int, data: bytes) -> None:
    """Add fields that the schema does not know to those of a record."""
    known = bytes(arena.content(lanes, node.span, node.lane, row))
    arena.replace(lanes, node, row, known + data)


def write_entry(entry: Entry, lanes: Lanes, row: int, value: Any, path: str = "", *, depth: int = 0) -> None:
    """Set one field."""
    arena.mark(lanes, entry.presence, row)
    write(entry.node, lanes, row, value, f"{path}.{entry.name}", depth=depth + 1)


def _store(node: Leaf, lanes: Lanes, row: int, value: Any, path: str) -> None:
    try:
        store(node, lanes, row, value)
    except (TypeError, ValueError, OverflowError) as problem:
        raise ValuesError(path, str(problem)) from None


def store(node: Leaf, lanes: Lanes, row: int, value: Any) -> None:
    """Make a value that of a leaf.

    Raises
    ------
    TypeError, ValueError
        As `rosetta_jit.runtime.holder.coerce` does. The leaf is as it was.
    """
    put(node, lanes, row, prepare(node, value))


def prepare(node: Leaf, value: Any) -> Any:
    """The value as `put` takes it: checked, and nothing changed."""
    match node:
        case Scalar(_, type_):
            return coerce.scalar(type_, value)
        case Text(_, _, type_):
            return coerce.text(type_, value)
        case Blob(_, _, length, maximum):
            data = coerce.blob(value)
            coerce.counted(len(data), length, maximum, "bytes")
            return data
        case Numbers(_, _, type_, length, maximum):
            array = coerce.numbers(type_, value)
            coerce.counted(array.size, length, maximum)
            return array
        case Items():
            return grid.prepare(node, value)
        case _:
            assert_never(node)


def put(node: Leaf, lanes: Lanes, row: int, prepared: Any) -> None:
    """Write what `prepare` made."""
    match node:
        case Scalar(cell, _):
            lanes.cells[cell.key][row * cell.step + cell.index] = prepared
            if node.choice is not None:
                arena.choose(lanes, node.choice, row)
        case Text() | Blob():
            arena.replace(lanes, node, row, prepared)
        case Numbers(_, lane):
            start = arena.resize(lanes, node, row, prepared.size)
            lanes.arrays[lane][start : start + prepared.size] = prepared
        case Items():
            grid.put(node, lanes, row, prepared)
        case _:
            assert_never(node)


def settle(record: Record, lanes: Lanes) -> None:
    """Make the lanes, which are one's own, fit to be encoded: nothing borrowed, and no rows that nothing refers to."""
    fresh = Lanes(lanes.plan, lanes.array_type)
    with fresh:
        fresh.reset(lanes.rows)
        for row in range(lanes.rows):
            write_record(record, fresh, row, read_record(record, lanes, row, Form.RAW))
    lanes.adopt(fresh)


def _check_length(count: int, node: Items, path: str) -> None:
    try:
        coerce.counted(count, node.length, node.maximum)
    except ValueError as problem:
        raise ValuesError(path, str(problem)) from None


def _sequence(value: Any, path: str) -> list[Any]:
    if not isinstance(value, Iterable) or isinstance(value, str | bytes | Mapping):
        raise ValuesError(path, f"expected a sequence, {_kind(value)} found")
    return list(cast("Iterable[Any]", value))


def _kind(value: Any) -> str:
    return type(value).__name__


def _mapping(value: Any, path: str) -> Mapping[Any, Any]:
    if not isinstance(value, Mapping):
        raise ValuesError(path, f"expected a dict, {type(value).__name__} found")
    return cast("Mapping[Any, Any]", value)
