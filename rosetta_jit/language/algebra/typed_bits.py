"""Bits of typed integers as digits: `x & 15` is `modulo(x, 16)`, `x >> 4` is `floor_divide(x, 16)`, `x & 4 != 0` is `bool` of a digit."""

from __future__ import annotations

from rosetta_jit.language.masks import MOST_BITS, lowest_of_run
from rosetta_jit.language.typed import BOOL, INT64, Binary, Call, Const, Convert, Expr, Unary


def digits(expr: Expr) -> Expr:
    """An operation on bits as one on digits; all others stay."""
    match expr:
        case Binary("&", value, Const(int(mask))) | Binary("&", Const(int(mask)), value) if (shift := lowest_of_run(mask)) is not None:
            found = Call("modulo", (_quotient(value, shift), Const((mask >> shift) + 1, INT64)), INT64)
            return Binary("*", found, Const(1 << shift, INT64), INT64) if shift else found
        case Binary(">>", value, Const(int(count))) if 0 < count <= MOST_BITS:
            return _quotient(value, count)
        case Binary("==" | "!=" as operator, value, Const(int(constant))):
            return _tested(value, constant, holds=operator == "==") or expr
        case _:
            return expr


def _quotient(value: Expr, shift: int) -> Expr:
    return value if not shift else Call("floor_divide", (value, Const(1 << shift, INT64)), INT64)


def _tested(value: Expr, constant: int, *, holds: bool) -> Expr | None:
    """Whether one bit is set, or is not; None of other comparisons."""
    match value:
        case Binary("*", Call("modulo", (_, Const(2))) as bit, Const(int(unit))):
            pass
        case Call("modulo", (_, Const(2))) as bit:
            unit = 1
        case _:
            return None
    if constant not in (0, unit):
        return None
    is_set = Convert(bit, BOOL, "exact")
    return is_set if holds == bool(constant) else Unary("not", is_set, BOOL)
