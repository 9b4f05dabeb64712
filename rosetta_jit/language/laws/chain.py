"""There and back: what is left of a value when all that was done to it is undone, as far as that can be shown.

An expression of one field is a chain of steps from it. Steps that are affine (`+ - * /` by constants, `radians`, conversions) are followed
as a slope and an offset, with the rounding of each; bijections of another kind (`^`, `not`, tables) must be met by their own inverses.

For the bound, what each step is off by (`rosetta_jit.language.laws.affine_steps`) is added. The sum over all steps is at most
ulp · ulp(max(|x|, floor)), as |v|·2^-p < ulp(v). Higham, Accuracy and Stability of Numerical Algorithms, chapter 3.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING
from typing import Literal as OneOf

from rosetta_jit.language.conversions import EXACT_BITS
from rosetta_jit.language.laws.affine_steps import LARGEST, PRECISION, Error, LostError, Value, fraction, rounded, scaled, shifted, turned
from rosetta_jit.language.laws.integers import as_whole, is_whole, squeezed
from rosetta_jit.language.laws.texts import inner_text, rounds_moment, undone, why_lost
from rosetta_jit.language.typed import Access, Binary, Call, Choice, Const, Convert, LenOf, Nearest, TextCall, Unary
from rosetta_jit.model.types import Float, Int
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.language.typed import Expr
    from rosetta_jit.model.types import Type

NANOSECOND = 4.6e6
"""Seconds whose float64, rounded, is off by at most half a nanosecond and what rounding that has added: 0.5000003e-9 · 2^53 and more."""

NEGLIGIBLE = 2.0**-800
"""A floor below that is that of no value of a float32."""


@dataclass(frozen=True, slots=True)
class Rounding:
    """|back - x| is at most ``ulp`` times the spacing of floats of so many ``bits`` at max(|x|, ``floor``), where |x| ≤ ``limit``."""

    ulp: int
    bits: OneOf[32, 64]
    floor: float = 0.0
    limit: float = math.inf


@dataclass(frozen=True, slots=True)
class Lost:
    """Some values do not come back."""

    why: str


Outcome = Rounding | Lost | None
"""None where every value comes back as it was."""

UNSHOWN = Lost("it cannot be shown that its value comes back")


def come_back(expr: Expr, goal: Expr) -> Outcome:
    """What is left of the field ``goal`` in an expression of it."""
    steps: list[Expr] = []
    while expr != goal:
        inner = _inner(expr)
        if inner is None:
            why = why_lost(expr)
            return UNSHOWN if why is None else Lost(why)
        steps.append(expr)
        expr = inner
    value = Value(goal.type, goal.type)
    try:
        for step in reversed(steps):
            value = _done(step, value)
    except LostError as error:
        return Lost(str(error))
    except OverflowError:
        return UNSHOWN
    return UNSHOWN if value.opened else _outcome(value)


def field_in(expr: Expr) -> Access | LenOf | None:
    """The field that an expression is a chain of steps from."""
    while not isinstance(expr, Access | LenOf):
        inner = _inner(expr)
        if inner is None:
            return None
        expr = inner
    return expr


def table_of(choice: Choice) -> tuple[Expr, dict[object, object], Const | None] | None:
    """A choice of constants by the value of one expression: that expression, the entries and the rest."""
    entries: dict[object, object] = {}
    subject: Expr | None = None
    for condition, value in choice.cases:
        match condition, value:
            case Binary("==", left, Const(key)), Const(known) if subject in (None, left):
                subject = left
                entries.setdefault(key, known)
            case _:
                return None
    if subject is None or not isinstance(choice.otherwise, Const | None):
        return None
    return subject, entries, choice.otherwise


def _inner(expr: Expr) -> Expr | None:
    """The part of a step that the field is in."""
    match expr:
        case Convert(operand) | Unary(_, operand) | Nearest(operand):
            return operand
        case Binary(_, left, Const()):
            return left
        case Binary(_, Const(), right):
            return right
        case Call("radians" | "degrees", (argument,)) | Call("divide" | "floor_divide", (argument, Const())):
            return argument
        case Choice():
            found = table_of(expr)
            return found[0] if found is not None else None
        case TextCall():
            return inner_text(expr)
        case _:
            return None


def _done(step: Expr, value: Value) -> Value:
    match step:
        case Convert(_, type_, rule):
            return _converted(value, type_, rule)
        case Nearest(type=type_):
            return as_whole(replace(value, type=type_), "round")
        case Unary("-"):
            return replace(scaled(value, Fraction(-1)), type=step.type)
        case Unary() | Choice() | TextCall():
            return _bijection(step, value)
        case Call("radians"):
            return rounded(replace(turned(value, 1), type=step.type), 2)
        case Call("degrees"):
            return rounded(replace(turned(value, -1), type=step.type), 2)
        case Call("divide", (_, Const(divisor))) if divisor:
            return rounded(replace(scaled(value, 1 / fraction(divisor)), type=step.type), 1)
        case Call("floor_divide", (_, Const(divisor))) if divisor:
            return _divided(step, value, divisor)
        case Binary("^"):
            return _bijection(step, value)
        case Binary():
            return _computed(step, replace(value, type=step.type))
        case _:
            raise LostError(UNSHOWN.why)


def _computed(step: Binary, value: Value) -> Value:
    match step:
        case Binary("+", left, right):
            constant = right if isinstance(right, Const) else left
            return rounded(shifted(value, fraction(_number(constant))), 1)
        case Binary("-", _, Const(number)):
            return rounded(shifted(value, -fraction(number)), 1)
        case Binary("-", Const(number), _):
            return rounded(shifted(scaled(value, Fraction(-1)), fraction(number)), 1)
        case Binary("*", left, right):
            constant = right if isinstance(right, Const) else left
            return rounded(scaled(value, fraction(_number(constant))), 1)
        case Binary("/", _, Const(number)) if number:
            return _divided(step, value, number)
        case _:
            raise LostError(f"`{step.operator}` gives the same for several values")


def _divided(step: Binary | Call, value: Value, divisor: object) -> Value:
    divided = scaled(value, 1 / fraction(divisor))
    if isinstance(step.type, Int) and not is_whole(divided):
        raise LostError(f"`{step.operator if isinstance(step, Binary) else step.function}` drops remainders")
    return rounded(divided, 1)


def _number(expr: Expr) -> object:
    return expr.value if isinstance(expr, Const) else None


# --- conversions -------------------------------------------------------------------------------------------------------


def _converted(value: Value, target: Type, rule: str) -> Value:
    converted = replace(value, type=target)
    match value.type, target:
        case _, Float() if rule == "exact":
            return converted
        case Float(bits), Float(other):
            return converted if other >= bits else rounded(converted, 1)
        case Int(bits), Float(other):
            came = value.is_itself and isinstance(value.source, Float) and value.source.bits <= other
            return converted if came or bits <= EXACT_BITS[other] else rounded(converted, 1)
        case Float(), Int():
            return as_whole(converted, rule)
        case Int(), Int() if rule in {"saturate", "wrap"}:
            return squeezed(value, converted, rule)
        case _:
            return converted


# --- bijections --------------------------------------------------------------------------------------------------------


def _bijection(step: Expr, value: Value) -> Value:
    """Met by its inverse, a step leaves what was before it."""
    if value.opened and value.is_itself:
        opening, before = value.opened[-1]
        if _undoes(step, opening):
            is_moment = isinstance(step, TextCall) and isinstance(opening, TextCall) and rounds_moment(step, opening)
            return _timed(before) if is_moment else before
    if isinstance(step, Choice):
        found = table_of(step)
        if found is None:
            raise LostError(UNSHOWN.why)
    return Value(step.type, step.type, opened=(*value.opened, (step, value)))


def _timed(value: Value) -> Value:
    """A float64 of seconds that is rounded to nanoseconds and put together again: off by at most half of one, and one rounding more."""
    floor = (value.offset + NANOSECOND) / value.size
    return replace(value, errors=(*value.errors, Error(2.0**-53, floor, is_tiny=False)))


def _undoes(step: Expr, opening: Expr) -> bool:
    match step, opening:
        case Unary("not"), Unary("not"):
            return True
        case Binary("^"), Binary("^"):
            return _constant_of(step) == _constant_of(opening)
        case Choice(), Choice():
            return _tables_undo(step, opening)
        case TextCall(), TextCall():
            found = undone(step, opening)
            if isinstance(found, str):
                raise LostError(found)
            return found
        case _:
            return False


def _constant_of(step: Binary) -> object:
    return _number(step.right if isinstance(step.right, Const) else step.left)


def _tables_undo(step: Choice, opening: Choice) -> bool:
    """Whether every key comes back; what does not is said."""
    back, there = table_of(step), table_of(opening)
    if back is None or there is None:
        return False
    for key, value in there[1].items():
        rest = back[2].value if back[2] is not None else None
        found = back[1].get(value, rest)
        if found != key:
            raise LostError(f"{_shown(key)} comes back as {_shown(found)}" if found is not None else f"{_shown(key)} does not come back")
    if there[2] is not None:
        raise LostError(f"all values without an entry of the table become {_shown(there[2].value)}")
    return True


def _shown(value: object) -> str:
    text = f'"{value}"' if isinstance(value, str) else repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


# --- the whole ---------------------------------------------------------------------------------------------------------


def _outcome(value: Value) -> Outcome:
    off, left = abs(float(value.slope) - 1.0) if not value.turns else 1.0, value.offset
    if off > 2.0**-40 or (left and left > 2.0**-40 * max((error.floor for error in value.errors), default=0.0)):
        return Lost("it comes back as another value")
    if not value.errors:
        return None
    if not isinstance(value.source, Float):
        return Lost("large integers are rounded to a float")
    source, errors = value.source.bits, value.errors
    if source == 32 and value.bits == 32 and all(error.unit < 2.0**-40 for error in errors[:-1]):
        # The last step rounds to the type that the value came from: what is off by less than half of its spacing comes back exactly.
        errors = tuple(replace(error, unit=2 * error.unit) for error in errors[:-1])
        value = replace(value, bits=64)
    floor = max((error.floor for error in errors), default=0.0)
    unit = sum(error.times() for error in errors) + off + (left / floor if left else 0.0)
    if source == 32 and floor < NEGLIGIBLE and unit < 2.0**-26:
        return None
    ulp = math.ceil(unit * 1.001 * 2.0 ** PRECISION[value.bits])
    limit = value.limit if value.limit < LARGEST[source] / 2 else math.inf
    return Rounding(ulp, value.bits, floor, limit)
