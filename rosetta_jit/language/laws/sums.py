"""Laws of fields that relations know only as sums of several: solved for each field, the sums give it back exactly but for rounding.

How far off they are depends on the other fields of the sums: a large one beside a small one leaves little of that.
"""

from __future__ import annotations

from fractions import Fraction
from math import isfinite, pi

from rosetta_jit.language.typed import Access, Binary, Call, Const, Convert, Expr, Unary
from rosetta_jit.model.types import Float

ALMOST = Fraction(1, 1 << 40)
"""How far factors may be from those of the field itself: constants that undo each other are rounded."""

ANGLES = {"radians": Fraction(pi / 180), "degrees": Fraction(180 / pi)}


def comes_back_rounded(value: Expr, goal: Expr) -> bool:
    """Whether an expression of floats is the field ``goal``, as far as rounding lets it: all others cancel out."""
    if not isinstance(goal, Access) or not isinstance(goal.type, Float):
        return False
    factors = _factors(value)
    return factors is not None and goal in factors and all(abs(factor - (field == goal)) < ALMOST for field, factor in factors.items())


def _factors(expr: Expr) -> dict[Expr | None, Fraction] | None:
    """What each field is multiplied by in a sum, None being the constant that is added; None where it is no sum."""
    match expr:
        case Access(type=Float()):
            return {expr: Fraction(1)}
        case Const(int() | float() as number) if isfinite(number):
            return {None: Fraction(number)}
        case Convert(operand, Float()):
            return _factors(operand)
        case Unary("-", operand):
            return _times(_factors(operand), Fraction(-1))
        case Binary("+" | "-" as operator, left, right):
            return _added(_factors(left), _times(_factors(right), Fraction(1 if operator == "+" else -1)))
        case Binary("*", factor, Const(int() | float() as number)) | Binary("*", Const(int() | float() as number), factor):
            return _times(_factors(factor), Fraction(number)) if isfinite(number) else None
        case Binary("/", total, Const(int() | float() as number)) | Call("divide", (total, Const(int() | float() as number))):
            return _times(_factors(total), 1 / Fraction(number)) if number and isfinite(number) else None
        case Call(function, (angle,)) if function in ANGLES:
            return _times(_factors(angle), ANGLES[function])
        case _:
            return None


def _times(factors: dict[Expr | None, Fraction] | None, by: Fraction) -> dict[Expr | None, Fraction] | None:
    return None if factors is None else {field: factor * by for field, factor in factors.items()}


def _added(left: dict[Expr | None, Fraction] | None, right: dict[Expr | None, Fraction] | None) -> dict[Expr | None, Fraction] | None:
    if left is None or right is None:
        return None
    return {field: left.get(field, Fraction(0)) + right.get(field, Fraction(0)) for field in {**left, **right}}
