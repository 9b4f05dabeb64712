"""Conversions on the way back that may refuse what came through the first direction.

`int8(x)` refuses a number that does not fit, and a fraction. The conversion of a whole value is left out here: where that value is known
to come back, it fits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from rosetta_jit.language.conversions import bounds, same
from rosetta_jit.language.laws.chain import come_back, source_of
from rosetta_jit.language.typed import Access, Convert, Expr, LenOf
from rosetta_jit.language.walk import parts
from rosetta_jit.model.types import Float, Int


def may_refuse(value: Expr, of: Callable[[Expr], Expr]) -> bool:
    """Whether a conversion within the value of a rule may refuse; ``of`` gives an expression as one of what the first direction read."""
    return any(not _fits(each, of) for each in _exact(value) if each is not value)


def _exact(expr: Expr) -> Iterator[Convert]:
    for part in parts(expr):
        match part:
            case Convert(operand, Int() | Float(), "exact") if isinstance(operand.type, Int | Float):
                yield part
            case _:
                pass


def _fits(conversion: Convert, of: Callable[[Expr], Expr]) -> bool:
    made = of(conversion)
    source = source_of(made)
    if isinstance(source, Access | LenOf) and same(source.type, conversion.type) and come_back(made, source) is None:
        return True
    if not isinstance(made, Convert) and same(made.type, conversion.type):  # it has met what it undoes
        return True
    source = of(conversion.operand).type
    if not isinstance(source, Int) or not isinstance(conversion.type, Int):
        return not isinstance(made, Convert) or made.rule != "exact"
    (low, high), (least, most) = bounds(source), bounds(conversion.type)
    return least <= low and high <= most
