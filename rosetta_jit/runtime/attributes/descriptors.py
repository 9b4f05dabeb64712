"""Attributes of a class that run the compiled accessors, and room in its objects for what these keep."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

from rosetta_jit.runtime import type_specs
from rosetta_jit.runtime.attributes.code import library
from rosetta_jit.runtime.attributes.field_table import PLACE_BYTES, KeptFields
from rosetta_jit.runtime.attributes.names import Names
from rosetta_jit.runtime.cells import SCALARS
from rosetta_jit.runtime.holder.record import Blob, Entry, Items, Numbers, Pairs, Record, Scalar, Text
from rosetta_jit.runtime.limits import MAX_VIEWS


def slots(entries: Iterable[Entry]) -> tuple[str, ...]:
    """Names of the slots in which messages keep what shows these fields."""
    return tuple(f"_kept_{number}" for number, entry in enumerate(entries) if is_kept(entry))


def is_kept(entry: Entry) -> bool:
    """Whether a message keeps what shows a field."""
    return isinstance(entry.node, Record | Pairs | Numbers) or (isinstance(entry.node, Items) and not entry.node.shape)


def take_slots(made: type, entries: Sequence[Entry]) -> KeptFields:
    """The offsets of a class's slots, each of which keeps the view of a field. They stop being attributes: only accessors use them."""
    offsets: dict[str, int] = {}
    for slot in slots(entries):
        offsets[entries[int(slot.rpartition("_")[2])].name] = type_specs.slot_offset(made.__dict__[slot])
        delattr(made, slot)
    records = [entry for entry in entries if isinstance(entry.node, Record)]
    few = sum(map(_records_within, records)) <= MAX_VIEWS
    return KeptFields(offsets, frozenset(entry.name for entry in records if few))


def _records_within(entry: Entry) -> int:
    """How many records lie in a row because of a field."""
    node = entry.node
    return 1 + sum(map(_records_within, node.entries.values())) if isinstance(node, Record) else 0


@cache
def assignable(base: type) -> type:
    """A subclass whose objects can assign to members (`describe`), as far as their type lets them."""
    code = library()
    assert code is not None, "there are members for it"
    created = type_specs.from_spec(
        base.__name__,
        base,
        base.__basicsize__,
        type_specs.DEFAULT | type_specs.BASETYPE,
        ((type_specs.TP_SETATTRO, code["set_attribute"]),),
    )
    names = {"__module__": base.__module__, "__qualname__": base.__qualname__, "__doc__": base.__doc__, "_code": code}
    return type_specs.with_attributes(created, names)


def describe(
    made: type, entries: Mapping[str, Entry], shown: Sequence[str], kept: KeptFields, *, plain_arrays: bool, has_methods: bool
) -> None:
    """Give a class an attribute for each field that is shown."""
    code = library()
    assert code is not None, "there are accessors"
    numbers = {name: number for number, name in enumerate(entries)}
    members = [name for name in shown if name in kept.members]
    computed = [name for name in shown if name not in kept.members]
    slots, table = (type_specs.Member * len(members))(), (type_specs.GetSet * len(computed))()
    for definition, name in zip(slots, members, strict=True):
        definition.name, definition.type, definition.offset, definition.flags = (
            _c_name(name),
            type_specs.OBJECT,
            kept.offsets[name],
            type_specs.READONLY,
        )
    for definition, name in zip(table, computed, strict=True):
        get, set_ = accessors(entries[name], plain_arrays=plain_arrays)
        definition.name, definition.get, definition.set = _c_name(name), code[get], code[set_]
        definition.closure = PLACE_BYTES * numbers[name]
    names = Names({name: (each.get, each.set, each.closure or 0) for name, each in zip(computed, table, strict=True)})
    made._attributes = slots, table, names  # noqa: SLF001 # pyright: ignore[reportAttributeAccessIssue] - the class is ours; they live as long as it
    for name, definition in zip(members, slots, strict=True):
        setattr(made, name, type_specs.member_of(made, definition))
    for name, definition in zip(computed, table, strict=True):
        setattr(made, name, type_specs.attribute_of(made, definition))
    names.give(made, reads=not kept.offsets and not has_methods)


def describe_view(made: type, holder_type: Any, kept: KeptFields | None) -> None:
    """Give a class of views the attributes of its holder class by their names."""
    if kept is not None:
        holder_type._attributes[2].give(made, reads=not kept.offsets)  # noqa: SLF001 - the class is ours


def _c_name(name: str) -> bytes:
    return name.encode(errors="backslashreplace")


def accessors(entry: Entry, *, plain_arrays: bool) -> tuple[str, str]:
    """The symbols of the getter and the setter of a field."""
    match entry.node:
        case Scalar(cell):
            scalar = SCALARS[cell.key & 15]
            return f"get_{scalar}", f"set_{scalar}"
        case Text(_, _, type_) if type_.encoding != "utf-16":
            return ("get_utf8", "set_utf8") if type_.encoding == "utf-8" else ("get_octets", "set_python")
        case Blob():
            return "get_bytes", "set_bytes"
        case Numbers() if plain_arrays:
            return "get_numbers", "set_numbers"
        case Items(element=Text(_, _, type_)) if plain_arrays and type_.encoding == "utf-8":
            return "get_kept", "set_texts"
        case _:
            return "get_kept" if is_kept(entry) and not isinstance(entry.node, Numbers) else "get_python", "set_python"
