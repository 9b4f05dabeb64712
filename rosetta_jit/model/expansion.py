"""What a type expands to, counted before anything expands it.

A type that is used twice is laid out, encoded and compiled twice. A schema whose every line uses the line before twice thus means a million
fields after twenty lines, and one of arrays of arrays more bytes than any memory has. Here each declared type is counted once, in time
proportional to the text, and a type beyond the budget is refused. A field that refers to a recursive struct counts as one: kernels of those
are routines.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from rosetta_jit.model.layout import SPAN_BYTES, WIDTH, scalar_of
from rosetta_jit.model.limits import MAX_BYTES, MAX_LINKS, MAX_NESTED, MAX_SLOTS
from rosetta_jit.model.recursive_structs import recursive_structs
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, replace


@dataclass(frozen=True, slots=True)
class Expansion:
    """Fields with those of the structs within, bytes with those of the arrays of fixed length, and how many structs lie in each other."""

    fields: int = 0
    size_bytes: int = 0
    nested: int = 0


def excess(struct: Struct, schema: Schema) -> str:
    """What of a type is beyond the budget; empty if nothing is."""
    recursive = recursive_structs(Ref(struct.name), schema)
    links = sum(each in recursive for name in recursive for each in _named(schema.types[name]))
    if links > MAX_LINKS:
        return f"its recursive structs refer to each other in more than {MAX_LINKS} fields"
    known: dict[str, Expansion] = {}
    for name in _inner_first(struct.name, schema):
        declared = schema.types[name]
        assert isinstance(declared, Struct)
        found = known[name] = _struct(declared, schema, recursive, known)
        why = _beyond(found)
        if why:
            return why
    return _beyond(_sum(each for name, each in known.items() if name in recursive or name == struct.name))


def _beyond(found: Expansion) -> str:
    if found.fields > MAX_SLOTS:
        return f"it unfolds to more than {MAX_SLOTS:,} fields"
    if found.size_bytes > MAX_BYTES:
        return f"its arrays may have more than {MAX_BYTES:,} bytes"
    return f"more than {MAX_NESTED} structs lie within each other" if found.nested > MAX_NESTED else ""


def _inner_first(root: str, schema: Schema) -> list[str]:
    """The structs that a struct reaches, those that another contains before it; of those that contain each other, in any order."""
    order: dict[str, None] = {}
    pending = [(root, False)]
    seen: set[str] = set()
    while pending:
        name, is_done = pending.pop()
        if is_done:
            order[name] = None
        elif name not in seen:
            seen.add(name)
            pending.append((name, True))
            pending += [(each, False) for each in _named(schema.types[name]) if isinstance(schema.types[each], Struct)]
    return list(order)


def _named(type_: Type) -> list[str]:
    """Names that a type refers to, in its own fields."""
    names: list[str] = []
    pending: list[Type] = [type_]
    while pending:
        match pending.pop():
            case Ref(name):
                names.append(name)
            case Array(element) | Optional(element):
                pending.append(element)
            case Map(key, value):
                pending += [key, value]
            case Struct(_, fields) | Union(_, fields):
                pending += [each.type for each in fields]
            case _:
                pass
    return names


def _struct(struct: Struct, schema: Schema, recursive: frozenset[str], known: dict[str, Expansion]) -> Expansion:
    """A struct, whose structs are known but those that contain it."""

    def of(type_: Type) -> Expansion:
        match type_:
            case Bool() | Int() | Float() | Enum():
                return Expansion(1, WIDTH[scalar_of(type_)])
            case String(maximum=maximum):
                return _repeated(Expansion(0, 1), None, maximum)
            case Bytes(_, length, maximum):
                return _repeated(Expansion(0, 1), length, maximum)
            case Array(element, length, maximum):
                return _repeated(of(element), length, maximum)
            case Map(key, value, maximum):
                return _repeated(_sum((of(key), of(value))), None, maximum)
            case Optional(value):
                return of(value)
            case Struct(_, fields) | Union(_, fields):
                inside = _sum(of(each.type) for each in fields)
                return Expansion(inside.fields + 1, inside.size_bytes, inside.nested)
            case Ref(name) if name in recursive:
                return Expansion(1, SPAN_BYTES)
            case Ref(name):
                declared = schema.types[name]
                return replace(known[name], nested=known[name].nested + 1) if isinstance(declared, Struct) else of(declared)
            case _:
                assert_never(type_)

    return of(struct)


def _repeated(element: Expansion, length: object, maximum: int | None) -> Expansion:
    """An array: its elements count as one field more, and as bytes where their number is fixed."""
    bytes_ = max(element.size_bytes, 1) * length if isinstance(length, int) else 0
    beyond = maximum if maximum is not None and maximum > MAX_BYTES else 0
    return Expansion(element.fields + 1, SPAN_BYTES + bytes_ + beyond, element.nested)


def _sum(parts: Iterable[Expansion]) -> Expansion:
    fields = size_bytes = nested = 0
    for each in parts:
        fields, size_bytes, nested = fields + each.fields, size_bytes + each.size_bytes, max(nested, each.nested)
    return Expansion(fields, size_bytes, nested)
