"""What a parameter may be: a number, a bool, a text or a list of these, of the type that the mapping declares."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from typing import cast

from rosetta_jit.language.conversions import holds
from rosetta_jit.language.limits import MAX_ITEMS, MAX_LIST_BYTES, MAX_PARAMETER_BYTES
from rosetta_jit.model.expr import Expr, List, Literal
from rosetta_jit.model.mapping import Parameter
from rosetta_jit.model.scalars import Scalar
from rosetta_jit.model.types import Bool, Float, Int, String, Type

SCALARS: Mapping[str, Scalar] = {
    "bool": Bool(),
    "int8": Int(8),
    "int16": Int(16),
    "int32": Int(32),
    "int64": Int(64),
    "uint8": Int(8, signed=False),
    "uint16": Int(16, signed=False),
    "uint32": Int(32, signed=False),
    "uint64": Int(64, signed=False),
    "float32": Float(32),
    "float64": Float(64),
    "string": String(),
}


def written(value: Expr) -> object:
    """What a constant of the text is in Python; the expression itself where it is none."""
    match value:
        case Literal(constant):
            return constant
        case List(items):
            return [written(item) for item in items]
        case _:
            return value


def accepted(value: object, parameter: Parameter) -> Expr | str:
    """A value as an expression; what is wrong with it otherwise."""
    type_ = SCALARS[parameter.type]
    if not parameter.is_list:
        return _scalar(value, type_, parameter.type)
    if not isinstance(value, list):
        return f"a list of {parameter.type} is needed, not {_shown(value)}"
    items = cast("list[object]", value)
    if len(items) > MAX_ITEMS:
        return f"a list has at most {MAX_ITEMS} items, not {len(items)}"
    if sum(len(item) for item in items if isinstance(item, str)) > MAX_LIST_BYTES:
        return f"the texts of a list have at most {MAX_LIST_BYTES} bytes together"
    found: list[Expr] = []
    for number, item in enumerate(items):
        known = _scalar(item, type_, parameter.type)
        if isinstance(known, str):
            return f"item {number}: {known}"
        found.append(known)
    return List(tuple(found))


def _scalar(value: object, type_: Type, name: str) -> Expr | str:
    match type_, value:
        case Bool(), bool():
            return Literal(value)
        case _, bool():
            return f"{name} is needed, not {_shown(value)}"
        case Int(), int():
            return Literal(value, type=type_) if holds(type_, value) else f"{_shown(value)} does not fit {name}"
        case Float(), int() | float():
            return _float(value, type_, name)
        case String(), str():
            return _text(value)
        case _:
            return f"{name} is needed, not {_shown(value)}"


def _float(value: float, type_: Float, name: str) -> Expr | str:
    """A float of its type; NaN and infinities are no constants."""
    try:
        number = float(value)
        rounded = number if type_.bits == 64 else struct.unpack("<f", struct.pack("<f", number))[0]
    except OverflowError:
        return f"{_shown(value)} does not fit {name}"
    if isinstance(value, int) and rounded != value:
        return f"{_shown(value)} does not fit {name}"
    return Literal(float(rounded), type=type_) if math.isfinite(rounded) else f"{_shown(value)} is not finite"


def _text(value: str) -> Expr | str:
    try:
        size = len(value.encode())
    except UnicodeEncodeError:
        return "the text cannot be written as UTF-8"
    return Literal(value) if size <= MAX_PARAMETER_BYTES else f"a text has at most {MAX_PARAMETER_BYTES} bytes, not {size}"


def _shown(value: object) -> str:
    match value:
        case list():
            return "a list"
        case bool() | int() | float() | str() | None:
            text = repr(value)
            return text if len(text) <= 40 else f"{text[:37]}..."
        case _:
            return "this"
