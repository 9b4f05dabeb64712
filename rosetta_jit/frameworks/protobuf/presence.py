"""Which fields of a message are set, missing, or unknown: asked of raw values, as `rosetta_jit.runtime.holder.values` reads them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from rosetta_jit.model.layout import UNKNOWN
from rosetta_jit.runtime.holder.record import Child, Entry, Items, Node, Pairs, Record
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import merge
else:
    merge = Late("rosetta_jit.runtime.holder.merge")


def set_entries(record: Record, values: Mapping[str, Any]) -> Iterator[tuple[Entry, Any]]:
    """The fields that protobuf regards as set, by number: those present, and of those without presence, what is not zero or empty."""
    for entry in sorted(record.entries.values(), key=lambda entry: entry.field.number or 0):
        if entry.name in values and (entry.presence is not None or not merge.is_zero(values[entry.name])):
            yield entry, values[entry.name]


def requires(record: Record) -> bool:
    """Whether a message, or one that it can contain, has a required field."""
    pending, seen = [record], set[int]()
    while pending:
        each = pending.pop()
        if any(entry.field.required for entry in each.entries.values()):
            return True
        if id(each) not in seen:
            seen.add(id(each))
            pending += [inner for entry in each.entries.values() for inner in _within(entry.node)]
    return False


def _within(node: Node) -> Iterator[Record]:
    match node:
        case Record():
            yield node
        case Child(record=record):
            yield record
        case Items(element=element):
            yield from _within(element)
        case Pairs(value=value):
            yield from _within(value.node)
        case _:
            pass


def missing(record: Record, values: Mapping[str, Any], path: str = "") -> Iterator[str]:
    """Paths of the required fields that are not set, as `FindInitializationErrors` gives them."""
    for entry in record.entries.values():
        if entry.field.required and entry.name not in values:
            yield path + entry.name
    for entry in record.entries.values():
        if entry.name in values:
            yield from _missing_in(entry.node, values[entry.name], path + entry.name)


def _missing_in(node: Node, value: Any, path: str) -> Iterator[str]:
    match node:
        case Record() | Child():
            yield from missing(node.record if isinstance(node, Child) else node, value, f"{path}.")
        case Items(_, _, Record() as element, _):
            for index, each in enumerate(value):
                yield from missing(element, each, f"{path}[{index}].")
        case Pairs(_, _, _, _, entry):
            for key, each in value.items():
                yield from _missing_in(entry.node, each, f"{path}[{key}]")
        case _:
            pass


def known(record: Record, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values without unknown fields, those of messages within included."""
    return {name: _known_in(record.entries[name].node, value) for name, value in values.items() if name != UNKNOWN}


def _known_in(node: Node, value: Any) -> Any:
    match node:
        case Record():
            return known(node, value)
        case Child():
            return known(node.record, value)
        case Items(_, _, Record() as element, _):
            return [known(element, each) for each in value]
        case Pairs(_, _, _, _, entry):
            return {key: _known_in(entry.node, each) for key, each in value.items()}
        case _:
            return value
