"""Expressions in their simplest form: conditions that are decided, steps that leave a value as it was, and calls that undo one another."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.language.conversions import adapt, same
from rosetta_jit.language.installed import functions
from rosetta_jit.language.laws.chain import come_back, source_of
from rosetta_jit.language.typed import BOOL, Binary, Call, Choice, Const, Convert, Expr, Listed, Nearest, Unary
from rosetta_jit.model.types import Float
from rosetta_jit.startup.dataclass import replace


def simplest(expr: Expr, own_part: Callable[[Expr], Expr | None]) -> Expr:
    """What can stand in place of an expression whose parts are simple; ``own_part`` finds the part of an integer that it is the same as."""
    match expr:
        case Convert(Const() as constant, type_, rule) if rule in {"widen", "exact", "nearest"}:
            return adapt(constant, type_) or expr
        case Unary("not", Const(bool(value))):
            return Const(not value, BOOL)
        case Binary("differs", left, right) if left == right:
            return Const(value=False, type=BOOL)
        case Binary("differs", Const(a), Const(b)):
            return Const(repr(a) != repr(b), BOOL)
        case Binary("==" | "!=" as operator, left, right) if left == right and not isinstance(left.type, Float):
            return Const(operator == "==", BOOL)
        case Binary("==" | "!=" as operator, Const(a), Const(b)):
            return Const((a == b) == (operator == "=="), BOOL)
        case Binary("and" | "or" as operator, left, right):
            return _logic(operator == "and", left, right, expr)
        case Choice(cases, otherwise):
            return _decided(cases, otherwise, expr)
        case Listed(items, Const(int(number))) if 0 <= number < len(items):
            return items[number]
        case Convert() | Unary() | Nearest():
            return _before(expr) or expr
        case Binary() | Call():
            return _before(expr) or own_part(expr) or _undoing(expr) or expr
        case _:
            return expr


def _logic(is_and: bool, left: Expr, right: Expr, expr: Expr) -> Expr:
    match left, right:
        case (Const(bool(value)), other) | (other, Const(bool(value))):
            return other if value == is_and else Const(value, BOOL)
        case _:
            return expr


def _decided(cases: tuple[tuple[Expr, Expr], ...], otherwise: Expr | None, choice: Choice) -> Expr:
    """A choice without the cases that cannot be."""
    left: list[tuple[Expr, Expr]] = []
    for condition, value in cases:
        match condition:
            case Const(bool(holds)):
                if holds:
                    return replace(choice, cases=tuple(left), otherwise=value) if left else value
            case _:
                left.append((condition, value))
    if not left and otherwise is not None:
        return otherwise
    return replace(choice, cases=tuple(left), otherwise=otherwise)


def _before(expr: Expr) -> Expr | None:
    """The value before all steps of an expression, if they leave it as it was."""
    source = source_of(expr)
    return source if source is not expr and same(source.type, expr.type) and come_back(expr, source) is None else None


def _undoing(expr: Expr) -> Expr | None:
    """What a call comes to that undoes the calls in its arguments."""
    undoes = functions()[expr.function].undoes if isinstance(expr, Call) else None
    return None if undoes is None or not isinstance(expr, Call) else undoes(expr)
