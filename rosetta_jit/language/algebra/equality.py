"""Equality of typed expressions; and whether one equals, in some round, what a rule in loops sets."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from rosetta_jit.language.algebra.polynomial import TooComplexError, polynomial_of
from rosetta_jit.language.algebra.quotients import NOTHING, Digit, Fact, Facts, are_same, mentions, only_atom, reduced
from rosetta_jit.language.conversions import bare
from rosetta_jit.language.typed import (
    BOOL,
    Access,
    Binary,
    Call,
    Const,
    Convert,
    Expr,
    Has,
    IndexStep,
    LenOf,
    Local,
    Nearest,
    StateVariable,
    Step,
    Unary,
)
from rosetta_jit.language.walk import operands, parts, renamed
from rosetta_jit.model.expr import Side
from rosetta_jit.model.types import Bool, Int
from rosetta_jit.startup.dataclass import replace

Ranges = tuple[tuple["Expr", "Expr"], ...]
"""Starts and stops of the loops around a rule."""


def unify(pattern: tuple[Step, ...], steps: tuple[Step, ...], bound: dict[str, Expr]) -> bool:
    """Whether a place is one that a rule in loops sets, and in which round."""
    if len(pattern) != len(steps):
        return False
    for wanted, step in zip(pattern, steps, strict=True):
        match wanted, step:
            case IndexStep(left), IndexStep(right):
                if not _matches(left, right, bound):
                    return False
            case _ if wanted != step:
                return False
            case _:
                pass
    return True


def _matches(pattern: Expr, expr: Expr, bound: dict[str, Expr]) -> bool:
    match pattern, expr:
        case Local(name), _:
            return bound.setdefault(name, expr) == expr
        case Binary(operator, left, right), Binary(other, a, b):
            return operator == other and _matches(left, a, bound) and _matches(right, b, bound)
        case Convert(operand, type_), Convert(inner, other_type):
            return type_ == other_type and _matches(operand, inner, bound)
        case _:
            return pattern == expr


def reads_other(value: Expr, side: Side) -> bool:
    """Whether an expression reads what lies between the two directions: nothing is known of that."""
    return any(isinstance(part, Access | LenOf | Has) and part.place.side != side for part in parts(value))


def has_local(expr: Expr) -> bool:
    """Whether an expression depends on the round of a loop."""
    return any(isinstance(part, Local) for part in parts(expr))


def has_state(expr: Expr) -> bool:
    """Whether an expression depends on what earlier messages have left."""
    return any(isinstance(part, StateVariable) for part in parts(expr))


def is_part(part: Expr, expr: Expr) -> bool:
    """Whether an expression has another one within it, or is it."""
    return any(each == part for each in parts(expr))


def fact(expr: Expr, value: Expr) -> Fact | None:
    """That a field or length is a number, for `same_number`."""
    if not isinstance(expr.type, Int) or not isinstance(value.type, Int):
        return None
    try:
        atom, known = only_atom(polynomial_of(expr)), polynomial_of(value)
    except TooComplexError:
        return None
    return None if atom is None or mentions(known, atom) else (atom, known)


def digit(above: Expr, truth: Callable[[Expr], bool | None]) -> Digit | None:
    """That an integer is from 0 to below a constant, if one condition says that it is not beyond, and ``truth`` that it is not below 0."""
    match above:
        case Binary(">=", value, Const(int(below))) if isinstance(value.type, Int) and truth(above) is False:
            if truth(Binary("<", value, Const(0, value.type), BOOL)) is not False:
                return None
            try:
                return polynomial_of(value), below
            except TooComplexError:
                return None
        case _:
            return None


def same_number(value: Expr, goal: Expr, facts: Facts = NOTHING) -> bool:
    """Whether two integers are the same where nothing is refused."""
    if not isinstance(value.type, Int) or not isinstance(goal.type, Int):
        return False
    try:
        return are_same(polynomial_of(value), polynomial_of(goal), _with_types(facts, value, goal))
    except TooComplexError:
        return False


def own_part(expr: Expr, facts: Callable[[], Facts]) -> Expr | None:
    """The part of an integer that it is the same as: of `floor_divide(x * c + y, c)` the x, if y is known to be from 0 to below c."""
    if not isinstance(expr.type, Int) or not _is_of_parts(expr):
        return None
    known = _with_types(facts(), expr)
    inner = (each for each in parts(expr) if each is not expr and isinstance(each.type, Int) and not isinstance(each, Const | Local))
    try:
        whole = reduced(polynomial_of(expr), known)
        return next((each for each in inner if reduced(polynomial_of(each), known) == whole), None)
    except TooComplexError:
        return None


def _with_types(facts: Facts, *exprs: Expr) -> Facts:
    """What is known besides: a field of an unsigned type is from 0 to below what that type cannot hold."""
    fields = {each for expr in exprs if _is_divided(expr) for each in parts(expr) if isinstance(each, Access)}
    unsigned = ((each, each.type) for each in fields if isinstance(each.type, Int) and not each.type.signed)
    return replace(facts, digits=(*facts.digits, *((polynomial_of(each), 1 << type_.bits) for each, type_ in unsigned)))


def _is_divided(expr: Expr) -> bool:
    return any(isinstance(each, Call) and each.function in ("floor_divide", "modulo") for each in parts(expr))


def _is_of_parts(expr: Expr) -> bool:
    """Whether an integer is a part of one that is put together, or is put together of parts."""
    within = {each.function if isinstance(each, Call) else each.operator for each in parts(expr) if isinstance(each, Call | Binary)}
    match expr:
        case Call("floor_divide" | "modulo"):
            has_flag = any(isinstance(each, Convert) and isinstance(each.operand.type, Bool) for each in parts(expr))
            return has_flag or not within.isdisjoint(("+", "*", "nanoseconds"))
        case Call("nanoseconds") | Binary("+"):
            return within.issuperset(("floor_divide", "modulo"))
        case _:
            return False


def is_of_digits(expr: Expr, integer: Expr) -> bool:
    """Whether a number is a sum of digits of an integer."""
    match expr:
        case Convert(operand) | Nearest(operand) | Unary(_, operand):
            return is_of_digits(operand, integer)
        case Binary("+", left, right):
            return is_of_digits(left, integer) and is_of_digits(right, integer)
        case Binary("*", left, Const()):
            return is_of_digits(left, integer)
        case Call("floor_divide" | "modulo", (inner, Const())):
            return bare(inner) == integer or is_of_digits(inner, integer)
        case _:
            return False


def given_back(value: Expr) -> Expr:
    """A value as what it was packed from, where it is what the check of a `Nearest` within it says that unpacking gives."""
    for each in _outermost_nearest(value):
        if renamed(each.check.right, {each.variable.name: each}) == value:
            return each.check.left
    return value


def _outermost_nearest(expr: Expr) -> Iterator[Nearest]:
    if isinstance(expr, Nearest):
        yield expr
        return
    for part in operands(expr):
        yield from _outermost_nearest(part)


def same_place(value: Expr, goal: Expr, facts: Facts = NOTHING) -> bool:
    """Whether two values lie at one place, whatever its indices look like."""
    if not isinstance(value, Access) or not isinstance(goal, Access) or len(value.place.steps) != len(goal.place.steps):
        return False
    pairs = zip(value.place.steps, goal.place.steps, strict=True)
    return value.place.side == goal.place.side and all(
        same_number(one.index, other.index, facts) if isinstance(one, IndexStep) and isinstance(other, IndexStep) else one == other
        for one, other in pairs
    )


def same_ranges(left: Ranges, right: Ranges, facts: Facts = NOTHING) -> bool:
    """Whether loops run over the same numbers."""
    pairs = [(a, b) for one, other in zip(left, right, strict=False) for a, b in zip(one, other, strict=True)]
    return len(left) == len(right) and all(same_number(a, b, facts) for a, b in pairs)
