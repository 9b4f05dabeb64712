"""The parts of typed expressions and rules, and the same ones of other parts: what every walk over them has in common.

`rosetta_jit.model.walk` is the same for expressions as a mapping writes them. The depth of an expression is bounded by the parser, so that
walks may be recursive.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.language.typed import (
    Access,
    Assign,
    Binary,
    Call,
    Choice,
    Const,
    Convert,
    Default,
    For,
    Given,
    Has,
    HostCall,
    Ignore,
    IndexStep,
    IsText,
    LenOf,
    Listed,
    Local,
    Nearest,
    Reduce,
    Reject,
    Search,
    SetLength,
    SetState,
    StateVariable,
    Unary,
    When,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rosetta_jit.language.typed import Expr, Place, Rule


def operands(expr: Expr) -> tuple[Expr, ...]:
    """The expressions that an expression is made of, the indices in its place first."""
    match expr:
        case Access(place) | LenOf(place) | IsText(place) | Has(place):
            return indices(place)
        case Search(place, _, condition):
            return (*indices(place), condition)
        case Reduce(_, _, count, value, _, refused):
            return (count, value, *(condition for condition, _ in refused))
        case Unary(_, operand) | Convert(operand):
            return (operand,)
        case Binary(_, left, right) | Nearest(left, check=right):
            return (left, right)
        case Call(_, arguments) | HostCall(_, arguments) | Given(_, arguments):
            return arguments
        case Choice(cases, otherwise, pieces=pieces):
            return (*(part for case in cases for part in case), *(() if otherwise is None else (otherwise,)), *pieces)
        case Listed(items, index):
            return (*items, index)
        case Const() | Local() | StateVariable():
            return ()
        case _:
            assert_never(expr)


def parts(expr: Expr) -> Iterator[Expr]:
    """Every part of an expression, itself first, those within indices included."""
    yield expr
    for part in operands(expr):
        yield from parts(part)


def rebuilt(expr: Expr, change: Callable[[Expr], Expr]) -> Expr:
    """The expression with each of its parts changed; of a `Nearest`, the check stays a comparison, of which both sides are changed."""
    match expr:
        case Access(place) | LenOf(place) | IsText(place) | Has(place):
            return replace(expr, place=placed(place, change))
        case Search(place, _, condition):
            return replace(expr, place=placed(place, change), condition=change(condition))
        case Reduce(_, _, count, value, _, refused):
            changed = tuple((change(condition), why) for condition, why in refused)
            return replace(expr, count=change(count), value=change(value), refused=changed)
        case Unary(_, operand) | Convert(operand):
            return replace(expr, operand=change(operand))
        case Binary(_, left, right):
            return replace(expr, left=change(left), right=change(right))
        case Nearest(operand, check=check):
            return replace(expr, operand=change(operand), check=replace(check, left=change(check.left), right=change(check.right)))
        case Call(_, arguments) | HostCall(_, arguments) | Given(_, arguments):
            return replace(expr, arguments=tuple(map(change, arguments)))
        case Choice(cases, otherwise, pieces=pieces):
            pairs = tuple((change(condition), change(value)) for condition, value in cases)
            rest = None if otherwise is None else change(otherwise)
            return replace(expr, cases=pairs, otherwise=rest, pieces=tuple(map(change, pieces)))
        case Listed(items, index):
            return replace(expr, items=tuple(map(change, items)), index=change(index))
        case Const() | Local() | StateVariable():
            return expr
        case _:
            assert_never(expr)


def indices(place: Place) -> tuple[Expr, ...]:
    """The indices on the way to a place."""
    return tuple(step.index for step in place.steps if isinstance(step, IndexStep))


def placed(place: Place, change: Callable[[Expr], Expr]) -> Place:
    """A place with its indices changed."""
    steps = tuple(replace(step, index=change(step.index)) if isinstance(step, IndexStep) else step for step in place.steps)
    return replace(place, steps=steps)


def renamed(expr: Expr, names: dict[str, Expr]) -> Expr:
    """The expression with expressions in place of loop variables."""
    if isinstance(expr, Local):
        return names.get(expr.name, expr)
    return rebuilt(expr, lambda part: renamed(part, names)) if names else expr


def expressions_of(rule: Rule) -> tuple[Expr, ...]:
    """The expressions that a rule computes itself, those of the rules within it left out."""
    match rule:
        case Assign(place, value) | SetLength(place, value):
            return (value, *indices(place))
        case Default(place):
            return indices(place)
        case For(_, start, stop, kept=kept):
            return (start, stop) if kept is None else (start, stop, kept.condition)
        case When(condition):
            return (condition,)
        case Reject(pieces=pieces):
            return pieces
        case SetState(_, value):
            return (value,)
        case Ignore():
            return ()
        case _:
            assert_never(rule)
