"""The hash by which ROS 2 tells versions of a type apart: SHA-256 of its description in JSON (REP 2011, REP 2016).

The numbers of types are the constants of ``type_description_interfaces/msg/FieldType``. Of `.idl` files too, as far as that has numbers.
"""

from __future__ import annotations

import json
from hashlib import sha256
from typing import Any

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.ros import diagnostics as say
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass

NESTED, CHAR, WCHAR, BOOLEAN, BYTE, STRING, WSTRING, BOUNDED_STRING, BOUNDED_WSTRING = 1, 13, 14, 15, 16, 17, 18, 21, 22
INTEGERS = {(8, True): 2, (8, False): 3, (16, True): 4, (16, False): 5, (32, True): 6, (32, False): 7, (64, True): 8, (64, False): 9}
FLOATS = {32: 10, 64: 11}
OCTETS = ("byte", "octet")
ARRAY, BOUNDED_SEQUENCE, SEQUENCE = 48, 96, 144
"""What is added to the number of the element."""


@dataclass(frozen=True, slots=True)
class _Kind:
    number: int
    capacity: int = 0
    text_capacity: int = 0
    nested: str = ""


def rihs01(struct: Struct, schema: Schema) -> str:
    """The type hash of a message, ``RIHS01_`` and 64 hexadecimal digits.

    Raises
    ------
    SchemaError
        It has fields of types that ROS 2 cannot describe.
    """
    needed = {_name(each): each for each in _needed(struct, schema)}
    referenced = [_described(needed[name], schema) for name in sorted(needed) if name != _name(struct)]
    description = {"type_description": _described(struct, schema), "referenced_type_descriptions": referenced}
    return f"RIHS01_{sha256(json.dumps(description).encode()).hexdigest()}"


def _name(struct: Struct) -> str:
    return struct.name.replace("::", "/")


def _needed(struct: Struct, schema: Schema) -> list[Struct]:
    """A struct and all that it contains, directly or not."""
    found = {struct.name: struct}
    waiting = [struct]
    while waiting:
        for field in waiting.pop().fields:
            inner = schema.resolve(field.type.element if isinstance(field.type, Array) else field.type)
            if isinstance(inner, Struct) and inner.name not in found:
                found[inner.name] = inner
                waiting.append(inner)
    return list(found.values())


def _described(struct: Struct, schema: Schema) -> dict[str, Any]:
    """A struct as ``IndividualTypeDescription`` says it in JSON; defaults are not hashed."""
    return {"type_name": _name(struct), "fields": [_field(struct, each, schema) for each in struct.fields]}


def _field(struct: Struct, field: Field, schema: Schema) -> dict[str, Any]:
    kind = _kind(field.type, schema, idl="::" in struct.name)
    if kind is None:
        raise SchemaError((say.no_type_hash(field.span, field.name),))
    numbers = {"type_id": kind.number, "capacity": kind.capacity, "string_capacity": kind.text_capacity}
    return {"name": field.name, "type": {**numbers, "nested_type_name": kind.nested}}


def _kind(type_: Type, schema: Schema, *, idl: bool) -> _Kind | None:
    resolved = schema.resolve(type_)
    match resolved:
        case Array(element, length, maximum):
            inner = None if isinstance(schema.resolve(element), Array | Bytes) else _kind(element, schema, idl=idl)
            return None if inner is None else _sequence(inner, length, maximum)
        case Bytes(spelling, length, maximum):
            return _sequence(_Kind(_integer(8, signed=False, spelling=spelling, idl=idl)), length, maximum)
        case Struct():
            return _Kind(NESTED, nested=_name(resolved))
        case String(encoding, _, maximum):
            plain, bounded = (WSTRING, BOUNDED_WSTRING) if encoding == "utf-16" else (STRING, BOUNDED_STRING)
            return _Kind(plain) if maximum is None else _Kind(bounded, text_capacity=maximum)
        case Bool():
            return _Kind(BOOLEAN)
        case Int(bits, signed, spelling):
            return _Kind(_integer(bits, signed=signed, spelling=spelling, idl=idl))
        case Float(bits):
            return _Kind(FLOATS[bits])
        case Enum() | Union() | Optional() | Map() | Ref():
            return None


def _integer(bits: int, *, signed: bool, spelling: str, idl: bool) -> int:
    """The number of an integer; `char` is a character in `.idl`, but in `.msg` another word for `uint8`."""
    if spelling in OCTETS:
        return BYTE
    if idl and spelling in ("char", "wchar"):
        return CHAR if spelling == "char" else WCHAR
    return INTEGERS[bits, signed]


def _sequence(inner: _Kind, length: object, maximum: int | None) -> _Kind:
    number, capacity = (ARRAY, length) if isinstance(length, int) else (BOUNDED_SEQUENCE, maximum) if maximum else (SEQUENCE, 0)
    return _Kind(inner.number + number, capacity or 0, inner.text_capacity, inner.nested)
