"""What a value of one type and unit has to go through to become one of another."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language.conversions import FLOAT64, describe, same, widens
from rosetta_jit.language.units.dimensions import conversion
from rosetta_jit.model.types import Bool, Bytes, Enum, Float, Int, String, Type

if TYPE_CHECKING:
    from rosetta_jit.draft.leaves import Leaf

ANGLES = {("degree", "radian"): "radians", ("radian", "degree"): "degrees"}


def kind(type_: Type) -> str:
    """Families of types that become each other without a decision: numbers, texts; an enum is one by itself."""
    match type_:
        case Bool() | Int() | Float():
            return "number"
        case String() | Bytes():
            return "text"
        case Enum(name=name):
            return f"enum {name}"
        case _:
            return describe(type_)


def converted(holder: Leaf, wire: Leaf, value: str) -> str | None:
    """The value of a wire's leaf as that of the holder's, as a rule says it; None where somebody must decide it."""
    scaled = in_unit(holder, wire, value)
    if scaled is None:
        return None
    inserted = holder.declared and wire.declared and None not in (holder.unit, wire.unit)
    return as_type(holder.type, wire.type if scaled == value else FLOAT64, value if inserted else scaled)


def in_unit(holder: Leaf, wire: Leaf, value: str) -> str | None:
    """The value in the unit of the holder's leaf, where both have one; None where these measure different things."""
    if wire.unit is None or holder.unit is None or wire.unit == holder.unit:
        return value
    found = conversion(wire.unit, holder.unit)
    if found is None or isinstance(found, str):
        return None
    factor, offset = found
    if (factor, offset) == (1.0, 0.0):
        return value
    for (source, target), function in ANGLES.items():
        if _is(wire.unit, source) and _is(holder.unit, target):
            return f"{function}({value})"
    product = value if factor == 1.0 else f"{value} * {factor!r}"
    return product if offset == 0.0 else f"{product} + {offset!r}"


def _is(unit: str, name: str) -> bool:
    return conversion(unit, name) == (1.0, 0.0)


def as_type(target: Type, source: Type, value: str) -> str | None:
    """A value as another type, with the word that says what happens to what does not fit."""
    name = describe(target)
    match target, source:
        case _ if same(target, source) or widens(source, target) or (kind(target), kind(source)) == ("text", "text"):
            return value
        case ((Bool() | Int() | Float()), (Bool() | Int() | Float())):
            return f"{name}({value})"
        case String(), (Int() | Float()):
            return f"text({value})"
        case Int(bits, signed), String():
            return f"integer({value})" if bits == 64 and signed else f"{name}(integer({value}))"
        case Float(bits), String():
            return f"number({value})" if bits == 64 else f"float32(number({value}))"
        case _:
            return None
