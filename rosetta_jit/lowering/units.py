"""Units of fields: what a value is measured in, and its conversion to what its place is measured in.

Where a value and its place have units, the conversion between them is inserted. `radians` and `degrees` take and give theirs, and a
value that was multiplied or divided is taken to have been converted by hand.
"""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any, cast

from rosetta_jit.catalogue import units as words
from rosetta_jit.lowering.conversions import FLOAT64, convert, describe
from rosetta_jit.lowering.typed import Access, Binary, Call, Choice, Const, Convert, FieldStep, Unary
from rosetta_jit.model.types import Float

if TYPE_CHECKING:
    from rosetta_jit.lowering.scope import Scope
    from rosetta_jit.lowering.typed import Expr, Place
    from rosetta_jit.source import Span

WORD = r"[A-Za-z_°µΩ]+(\^?-?[0-9]{1,2})?"
UNIT = re.compile(rf"{WORD}([*/ ·]{WORD})*")
"""What is given to the library that knows units: words with small powers, multiplied and divided."""
MAX_UNIT = 64

GIVES = {"radians": "radian", "degrees": "degree"}
TAKES = {"radians": "degree", "degrees": "radian"}
KEEPS = frozenset(("abs", "min", "max", "round", "floor", "ceil"))


def in_unit(value: Expr, place: Place, scope: Scope) -> Expr | None:
    """The value in the unit of its place; None, and reported, where that cannot be."""
    known, wanted = unit_of(value), unit_at(place)
    if _is_plain(value) and (known is None) != (wanted is None):
        scope.problems.append(words.one_sided(value.span, known or wanted or "", is_source=wanted is None))
    if known is None or wanted is None or known == wanted:
        return value
    factors = conversion(known, wanted)
    if isinstance(factors, str):
        scope.problems.append(words.unknown_unit(value.span, factors))
        return value
    if factors is None:
        scope.problems.append(words.incompatible(value.span, known, wanted))
        return None
    return value if factors == (1.0, 0.0) else _converted(value, place, factors, scope)


def unit_at(place: Place) -> str | None:
    """The unit of the last field on the way to a place."""
    fields = [step.field for step in place.steps if isinstance(step, FieldStep)]
    return fields[-1].unit if fields else None


def unit_of(value: Expr) -> str | None:
    """What a value is measured in, if that is known."""
    match value:
        case Access(place):
            return unit_at(place)
        case Unary(_, operand) | Convert(operand):
            return unit_of(operand)
        case Binary("+" | "-", left, right):
            return unit_of(left) or unit_of(right)
        case Call(function) if function in GIVES:
            return GIVES[function]
        case Call(function, (first, *_)) if function in KEEPS:
            return unit_of(first)
        case Choice(cases, otherwise):
            return next((unit for case in (*(value for _, value in cases), otherwise) if case and (unit := unit_of(case))), None)
        case _:
            return None


def check_argument(function: str, argument: Expr, span: Span | None, scope: Scope) -> bool:
    """Whether an argument of `radians` or `degrees` is measured in what they take."""
    known = unit_of(argument)
    if function not in TAKES or known is None or conversion(known, TAKES[function]) == (1.0, 0.0):
        return True
    scope.problems.append(words.wrong_way(span, function, known, TAKES[function]))
    return False


@cache
def conversion(source: str, target: str) -> tuple[float, float] | str | None:
    """Factor and offset from one unit to another; None where they measure different things; the name of a unit that is not known."""
    if source == target:
        return 1.0, 0.0
    unknown = next((unit for unit in (source, target) if len(unit) > MAX_UNIT or not UNIT.fullmatch(unit)), None)
    if unknown is not None:
        return unknown
    from pint import DimensionalityError, UndefinedUnitError

    registry = _registry()
    try:
        zero, one = (float(registry.Quantity(value, source).to(target).magnitude) for value in (0.0, 1.0))
    except UndefinedUnitError:
        return source if source not in registry else target
    except DimensionalityError:
        return None
    return one - zero, zero


@cache
def _registry() -> Any:
    import pint

    return cast("Any", pint).UnitRegistry()  # its types are known in part only


def _converted(value: Expr, place: Place, factors: tuple[float, float], scope: Scope) -> Expr | None:
    """The value times the factor, plus the offset, in float64."""
    wide, target = convert(value, FLOAT64), place.type
    if wide is None or not isinstance(target, Float):
        scope.problems.append(words.no_float(value.span, describe(value.type if wide is None else target)))
        return None
    factor, offset = factors
    result: Expr = Binary("*", wide, Const(factor, FLOAT64), FLOAT64, value.span)
    if offset:
        result = Binary("+", result, Const(offset, FLOAT64), FLOAT64, value.span)
    return result if target.bits == FLOAT64.bits else Convert(result, target, "nearest", value.span)


def _is_plain(value: Expr) -> bool:
    """Whether a value is a field as it came, with nothing done to it that could be a conversion by hand."""
    match value:
        case Access():
            return True
        case Convert(operand) | Unary(_, operand):
            return _is_plain(operand)
        case _:
            return False
