"""One form for the messages that our front ends and rosidl's own tools read: types are spelled as `.msg` files spell them."""

from __future__ import annotations

import json

from rosetta_jit.model.types import Array, Bool, Bytes, Float, Int, Ref, String

DUMMY = "structure_needs_at_least_one_member"
OCTETS = {"octet": "byte", "uint8": "uint8", "char": "uint8", "byte": "byte"}


def shape(struct):
    """The fields and constants of a message, with defaults."""
    fields = [[field.name, spelled(field.type), default_of(field)] for field in struct.fields if field.name != DUMMY]
    return {"fields": fields, "constants": [[each.name, spelled(each.type), each.value] for each in struct.constants]}


def spelled(type_):
    match type_:
        case Bool():
            return "bool"
        case Int(8) if type_.spelling in OCTETS:
            return OCTETS[type_.spelling]
        case Int(bits, signed):
            return f"{'' if signed else 'u'}int{bits}"
        case Float(bits):
            return f"float{bits}"
        case String(encoding, _, maximum):
            return ("wstring" if encoding == "utf-16" else "string") + (f"<={maximum}" if maximum else "")
        case Bytes(word, length, maximum):
            return OCTETS[word] + array(length, maximum)
        case Array(element, length, maximum):
            return spelled(element) + array(length, maximum)
        case Ref(name):
            return name.replace("::", "/")
    raise AssertionError(type_)


def array(length, maximum):
    return f"[{length}]" if length else f"[<={maximum}]" if maximum else "[]"


def default_of(field):
    if field.option("default") is not None:
        return json.loads(field.option("default"))
    return list(field.default) if isinstance(field.default, bytes) else field.default
