"""Types in words for people: what a field holds, in which unit, and of which shape. Names of schemas are escaped, and stay names."""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.model.limits import MAX_LISTED
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union


def field_words(field: Field, schema: Schema) -> str:
    """What a field holds, in which unit: ``float64[3], rad``."""
    presence = ", may be absent" if isinstance(field.type, Optional) else ""
    return f"{type_words(field.type, schema)}{unit_words(field)}{presence}"


def unit_words(field: Field) -> str:
    """The unit of a field behind a comma; those of its parts, where they differ."""
    if field.unit is not None:
        return f", {escaped(field.unit)}"
    parts = [f"{_place(way)} in {escaped(unit)}" for way, unit in field.part_units]
    return f", {', '.join(parts)}" if parts else ""


def type_words(type_: Type, schema: Schema) -> str:
    """A type in a few words."""
    match type_:
        case Bool():
            return "bool"
        case Int(bits, signed):
            return f"{'' if signed else 'u'}int{bits}"
        case Float(bits):
            return f"float{bits}"
        case String(maximum=maximum):
            return "text" if maximum is None else f"text of at most {maximum}"
        case Bytes(_, length, maximum):
            return f"bytes{_extent(length, maximum)}"
        case Enum(name, values):
            return f"{_short(name)}: {_listed(values)}"
        case Array():
            return _array(type_, schema)
        case Map(key, value):
            return f"map of {type_words(key, schema)} to {type_words(value, schema)}"
        case Optional(value):
            return type_words(value, schema)
        case Ref():
            resolved = schema.resolve(type_)
            return _short(resolved.name) if isinstance(resolved, Struct) else type_words(resolved, schema)
        case Struct(name) | Union(name):
            return _short(name)
        case _:
            assert_never(type_)


def escaped(text: str) -> str:
    """A text of a schema in one line of printable ASCII."""
    return "".join(each if " " <= each <= "~" and each != "\\" else ascii(each)[1:-1] for each in text)


def _array(type_: Array, schema: Schema) -> str:
    """An array of numbers with its shape, ``float64[3, 3]``; others as ``Pose[]``."""
    lengths, element = [_length(type_)], type_.element
    while isinstance(element, Array) and type_.fixed is not None and element.fixed is not None:
        lengths.append(_length(element))
        element = element.element
    resolved = schema.resolve(element)
    words = _short(resolved.name) if isinstance(resolved, Enum) else type_words(element, schema)
    return f"{words}[{', '.join(lengths)}]"


def _length(type_: Array) -> str:
    if type_.fixed is not None:
        return str(type_.fixed)
    return "" if type_.maximum is None else f"at most {type_.maximum}"


def _extent(length: object, maximum: int | None) -> str:
    if isinstance(length, int):
        return f"[{length}]"
    return "" if maximum is None else f"[at most {maximum}]"


def _listed(values: tuple[tuple[str, int], ...]) -> str:
    listed = ", ".join(f"{escaped(name)} = {number}" for name, number in values[:MAX_LISTED])
    return listed if len(values) <= MAX_LISTED else f"{listed}, {len(values) - MAX_LISTED} more"


def _place(way: tuple[str | int | None, ...]) -> str:
    return "".join(f".{escaped(step)}" if isinstance(step, str) else f"[{'' if step is None else step}]" for step in way)


def _short(name: str) -> str:
    """The last part of a qualified name."""
    return escaped(name.replace("::", "/").replace(".", "/").rpartition("/")[2])
