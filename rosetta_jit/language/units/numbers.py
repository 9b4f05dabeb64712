"""Numbers in another unit: floats are scaled in float64, integers exactly, or as the nearest one where packing has to find it again.

| value, place        | unpacking                              | packing                                        |
|---------------------|----------------------------------------|------------------------------------------------|
| any → float         | value * factor + offset                | the same                                       |
| integer → integer   | value * n; a fraction needs a word     | divide(value, n) where unpacking multiplies    |
| float → integer     | needs a word, which rounds afterwards  | the nearest integer, if it unpacks to the value |
"""

from __future__ import annotations

import math

from rosetta_jit.language.conversions import FLOAT64, as_int64, convert
from rosetta_jit.language.typed import BOOL, INT64, Access, Binary, Call, Const, Convert, Expr, Local, Nearest
from rosetta_jit.model.expr import NEAREST
from rosetta_jit.model.types import Float, Int, Type
from rosetta_jit.startup.dataclass import replace

Factors = tuple[float, float]
"""What a value is multiplied by, and what is added then."""

TOLERANCE = 1e-12
"""How far the factor between two units, which was computed in floats, may be from a whole number that it is."""


def scaled(value: Expr, target: Type, factors: Factors) -> Expr | None:
    """The value times the factor, plus the offset, in float64; None where one of the two is no float."""
    wide = convert(value, FLOAT64)
    if wide is None or not isinstance(target, Float):
        return None
    factor, offset = factors
    result: Expr = Binary("*", wide, Const(factor, FLOAT64), FLOAT64, value.span)
    if offset:
        result = Binary("+", result, Const(offset, FLOAT64), FLOAT64, value.span)
    return result if target.bits == FLOAT64.bits else Convert(result, target, "nearest", value.span)


def scaled_before_rounding(value: Expr, factors: Factors) -> Expr | None:
    """A float that a word makes an integer: in its new unit before that; None of all other values."""
    if not (isinstance(value, Convert) and isinstance(value.operand.type, Float) and isinstance(value.type, Int)):
        return None
    number = scaled(value.operand, FLOAT64, factors)
    return None if number is None else replace(value, operand=number)


def nearest(value: Access, target: Int, factors: Factors, back: Factors) -> Expr | None:
    """The integer nearest to a float in its new unit, if ``back`` gives the very float again."""
    number, variable = scaled(value, FLOAT64, factors), Local(NEAREST, target)
    wide = convert(variable, FLOAT64) or Convert(variable, FLOAT64, "nearest")
    again = scaled(wide, value.type, back)
    if number is None or again is None:
        return None
    return Nearest(number, variable, Binary("==", value, again, BOOL, value.span), target, value.span)


def exactly(value: Expr, target: Int, factors: Factors, *, packs: bool) -> Expr | None:
    """An integer times a whole factor or, where it ``packs``, divided by one without a remainder; None where it is neither."""
    wide, (factor, offset) = as_int64(value), factors
    times, parts = whole(factor), whole(1 / factor)
    if wide is None or offset:
        return None
    if times is not None:
        found: Expr = Binary("*", wide, Const(times, INT64), INT64, value.span)
    elif parts is not None and packs:
        found = Call("divide", (wide, Const(parts, INT64)), INT64, value.span)
    else:
        return None
    return convert(found, target) or Convert(found, target, "exact", value.span)


def whole(factor: float) -> int | None:
    """The whole number that a factor is, if it is one."""
    number = round(factor) if 1 <= abs(factor) < 1 << 62 else 0
    return number if number and math.isclose(number, factor, rel_tol=TOLERANCE) else None
