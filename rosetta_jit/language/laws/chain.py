"""The law of a chain of steps: what comes back of a value when each step is undone in turn, as far as that can be shown.

An expression of one field is a chain of steps from it. Steps that are affine (`+ - * /` by constants, `radians`, conversions) are followed
as a slope and an offset, with the rounding of each; bijections of another kind (`^`, `not`, tables) must be met by their own inverses.

For the bound, what each step is off by (`rosetta_jit.language.affine_steps`) is added. The sum over all steps is at most
ulp · ulp(max(|x|, floor)), as |v|·2^-p < ulp(v). Higham, Accuracy and Stability of Numerical Algorithms, chapter 3.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Literal as OneOf

from rosetta_jit.language.affine_steps import LARGEST, PRECISION, LostError, Value, rounded, scaled
from rosetta_jit.language.affine_steps import UNSHOWN as NOT_SHOWN
from rosetta_jit.language.conversions import EXACT_BITS, bounds
from rosetta_jit.language.function import Affine, NotFollowed, Undone
from rosetta_jit.language.image_orders import ORDERED
from rosetta_jit.language.installed import functions
from rosetta_jit.language.operators import form_of, why_lost
from rosetta_jit.language.typed import Binary, Call, Choice, Const, Convert, Expr, Given, Nearest, Unary
from rosetta_jit.model.types import Float, Int, Type
from rosetta_jit.startup.dataclass import dataclass, replace

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

UNSHOWN = Lost(NOT_SHOWN)


def come_back(expr: Expr, goal: Expr) -> Outcome:
    """What is left of the field ``goal`` in an expression of it."""
    steps: list[Expr] = []
    while expr != goal:
        inner = _inner(expr)
        if inner is None:
            return _why_lost(expr)
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


def source_of(expr: Expr) -> Expr:
    """What an expression is a chain of steps from: a field, or a value of several."""
    while (inner := _inner(expr)) is not None:
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
        case Call(function, arguments) if not isinstance(functions()[function].law, NotFollowed):
            unknown = [each for each in arguments if not isinstance(each, Const | Given)]
            return unknown[0] if len(unknown) == 1 else None
        case Choice():
            found = table_of(expr)
            return found[0] if found is not None else None
        case _:
            return None


def _why_lost(expr: Expr) -> Lost:
    """Why no part of a value of several comes back, where that is known."""
    if not isinstance(expr, Call):
        return UNSHOWN
    law = functions()[expr.function].law
    if isinstance(law, Undone) and law.of_several is not None:
        return Lost(law.of_several)
    parts = expr.arguments[:1] if expr.function == ORDERED else expr.arguments  # the others say how the first lies
    return next((why for part in parts if (why := _why_part_lost(part, expr)) != UNSHOWN), UNSHOWN)


def _why_part_lost(part: Expr, whole: Call) -> Lost:
    """Why one of several parts does not come back, where that is known."""
    source = source_of(part)
    found = come_back(part, source)
    return found if isinstance(found, Lost) and found != UNSHOWN else UNSHOWN if source == whole else _why_lost(source)


def _done(step: Expr, value: Value) -> Value:
    match step:
        case Convert(operand, Float(32), "nearest") if value.opened and value.is_itself and operand.type == Float(64):
            return _bijection(step, value)
        case Convert(_, type_, rule):
            return _converted(value, type_, rule)
        case Nearest(type=type_):
            return as_whole(replace(value, type=type_), "round")
        case Unary("-"):
            return replace(scaled(value, -1), type=step.type)
        case Unary() | Choice():
            return _bijection(step, value)
        case Call():
            law = functions()[step.function].law
            return law.follow(step, value) if isinstance(law, Affine) else _bijection(step, value)
        case Binary():
            return _computed(step, value)
        case _:
            raise LostError(UNSHOWN.why)


def _computed(step: Binary, value: Value) -> Value:
    is_left = isinstance(step.right, Const)
    form = form_of(step.operator, is_left=is_left)
    if form is None:
        raise LostError(why_lost(step.operator))
    if form.follow is None:
        return _bijection(step, value)
    return form.follow(replace(value, type=step.type), _number(step.right if is_left else step.left))


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
        back = _undone(step, opening, before)
        if back is not None:
            return back
    if isinstance(step, Choice):
        found = table_of(step)
        if found is None:
            raise LostError(UNSHOWN.why)
    return Value(step.type, step.type, opened=(*value.opened, (step, value)))


def _undone(step: Expr, opening: Expr, before: Value) -> Value | None:
    """The value before a step and the one that undoes it; None where it does not."""
    match step, opening:
        case Unary("not"), Unary("not"):
            return before
        case Binary("^"), Binary("^"):
            return before if _constant_of(step) == _constant_of(opening) else None
        case Choice(), Choice():
            return before if _tables_undo(step, opening) else None
        case Call(), Call(function):
            law = functions()[function].law
            back = law.by.get(step.function) if isinstance(law, Undone) else None
            return None if back is None else back(opening, step, before)
        case Convert(), Call(function):
            law = functions()[function].law
            return law.rounded(before) if isinstance(law, Undone) and law.rounded is not None else None
        case Call(), Convert() if before.opened:
            try:
                _undone(step, *before.opened[-1])
            except LostError as error:
                raise LostError(f"it is rounded to a float32, and {error}") from None
            return None
        case _:
            return None


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


WHOLE = {
    "round": "it is rounded to a whole number",
    "truncate": "what is behind the point is dropped",
    "saturate": "it is rounded to a whole number that fits",
}
"""What becomes of a float that is made an integer."""


FRACTION = 1e-6
"""A factor farther from a whole number than that was meant to be none."""


def as_whole(value: Value, rule: str) -> Value:
    """What is left of an integer that was computed with floats, when it is made an integer again."""
    if not isinstance(value.source, Int):
        if rule == "exact":
            return value
        raise LostError(WHOLE[rule])
    if not value.errors:
        return value
    if rule == "truncate":
        raise LostError(WHOLE[rule])
    largest = float(1 << value.source.bits)
    off = sum(error.unit * (largest + error.floor) for error in value.errors) * value.size
    near = near_whole(value)
    if not value.turns and abs(value.slope - round(value.slope)) > FRACTION and rule == "round":
        raise LostError(WHOLE[rule])
    if near is None or off + near[1] >= 0.25 or largest > value.limit:
        raise LostError("large integers are rounded to a float")
    if rule == "exact":
        raise LostError("it is refused where rounding leaves a fraction")
    return near[0]


def near_whole(value: Value) -> tuple[Value, float] | None:
    """A value with whole numbers in place of a slope and an offset that are nearly so, and how far off that is; None for radians."""
    if value.turns or any(turns for turns, _ in value.offsets) or not isinstance(value.source, Int):
        return None
    slope, offset = value.slope, sum((offset for _, offset in value.offsets), Fraction(0))
    off = abs(slope - round(slope)) * (1 << value.source.bits) + abs(offset - round(offset))
    offsets = ((0, Fraction(round(offset))),) if round(offset) else ()
    return replace(value, slope=Fraction(round(slope)), offsets=offsets, errors=()), float(off)


def squeezed(before: Value, after: Value, rule: str) -> Value:
    """An integer made to fit: nothing is lost where it fits anyway."""
    if isinstance(before.source, Int) and isinstance(after.type, Int) and before.slope == 1 and not before.offsets:
        low, high = bounds(before.source)
        least, most = bounds(after.type)
        if least <= low and high <= most:
            return after
    raise LostError("values that do not fit are saturated" if rule == "saturate" else "values that do not fit are wrapped")
