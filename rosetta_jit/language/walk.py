"""The parts of typed expressions and rules, and the same ones of other parts: what every walk over them has in common.

`rosetta_jit.model.walk` is the same for expressions as a mapping writes them. The depth of an expression is bounded by the parser, so that
walks may be recursive.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import assert_never

from rosetta_jit.language import typed
from rosetta_jit.model.walk import changed, renewed


def operands(expr: typed.Expr) -> tuple[typed.Expr, ...]:
    """The expressions that an expression is made of, the indices in its place first."""
    match expr:
        case typed.Access(place) | typed.LenOf(place) | typed.IsText(place) | typed.Has(place):
            return indices(place)
        case typed.Search(place, _, condition):
            return (*indices(place), condition)
        case typed.Reduce(_, _, count, value, _, refused):
            return (count, value, *(condition for condition, _ in refused), *(() if expr.chosen is None else (expr.chosen,)))
        case typed.Unary(_, operand) | typed.Convert(operand):
            return (operand,)
        case typed.Binary(_, left, right) | typed.Nearest(left, check=right):
            return (left, right)
        case typed.Call(_, arguments) | typed.HostCall(_, arguments) | typed.Given(_, arguments):
            return arguments
        case typed.Choice(cases, otherwise, pieces=pieces):
            return (*(part for case in cases for part in case), *(() if otherwise is None else (otherwise,)), *pieces)
        case typed.Listed(items, index):
            return (*items, index)
        case typed.Const() | typed.Local() | typed.StateVariable():
            return ()
        case _:
            assert_never(expr)


def parts(expr: typed.Expr) -> Iterator[typed.Expr]:
    """Every part of an expression, itself first, those within indices included."""
    yield expr
    for part in operands(expr):
        yield from parts(part)


def rebuilt(expr: typed.Expr, change: Callable[[typed.Expr], typed.Expr]) -> typed.Expr:
    """The expression with each of its parts changed; of a `Nearest`, the check stays a comparison, of which both sides are changed."""
    match expr:
        case typed.Access(place) | typed.LenOf(place) | typed.IsText(place) | typed.Has(place):
            return renewed(expr, place=placed(place, change))
        case typed.Search(place, _, condition):
            return renewed(expr, place=placed(place, change), condition=change(condition))
        case typed.Reduce(_, _, count, value, _, refused):
            why_not = tuple((change(condition), why) for condition, why in refused)
            chosen = None if expr.chosen is None else change(expr.chosen)
            assert chosen is None or isinstance(chosen, typed.Reduce)
            return renewed(expr, count=change(count), value=change(value), refused=why_not, chosen=chosen)
        case typed.Unary(_, operand) | typed.Convert(operand):
            return renewed(expr, operand=change(operand))
        case typed.Binary(_, left, right):
            return renewed(expr, left=change(left), right=change(right))
        case typed.Nearest(operand, check=check):
            return renewed(expr, operand=change(operand), check=renewed(check, left=change(check.left), right=change(check.right)))
        case typed.Call(_, arguments) | typed.HostCall(_, arguments) | typed.Given(_, arguments):
            return renewed(expr, arguments=changed(arguments, change))
        case typed.Choice(cases, otherwise, pieces=pieces):
            pairs = tuple((change(condition), change(value)) for condition, value in cases)
            rest = None if otherwise is None else change(otherwise)
            return renewed(expr, cases=pairs, otherwise=rest, pieces=changed(pieces, change))
        case typed.Listed(items, index):
            return renewed(expr, items=changed(items, change), index=change(index))
        case typed.Const() | typed.Local() | typed.StateVariable():
            return expr
        case _:
            assert_never(expr)


def indices(place: typed.Place) -> tuple[typed.Expr, ...]:
    """The indices on the way to a place."""
    return tuple(step.index for step in place.steps if isinstance(step, typed.IndexStep))


def placed(place: typed.Place, change: Callable[[typed.Expr], typed.Expr]) -> typed.Place:
    """A place with its indices changed."""

    def stepped(step: typed.Step) -> typed.Step:
        return renewed(step, index=change(step.index)) if isinstance(step, typed.IndexStep) else step

    return renewed(place, steps=changed(place.steps, stepped))


def renamed(expr: typed.Expr, names: dict[str, typed.Expr]) -> typed.Expr:
    """The expression with expressions in place of loop variables."""
    if isinstance(expr, typed.Local):
        return names.get(expr.name, expr)
    return rebuilt(expr, lambda part: renamed(part, names)) if names else expr


def expressions_of(rule: typed.Rule) -> tuple[typed.Expr, ...]:
    """The expressions that a rule computes itself, those of the rules within it left out."""
    match rule:
        case typed.Assign(place, value) | typed.SetLength(place, value):
            return (value, *indices(place))
        case typed.Default(place):
            return indices(place)
        case typed.For(_, start, stop, kept=kept):
            return (start, stop) if kept is None else (start, stop, kept.condition)
        case typed.When(condition):
            return (condition,)
        case typed.Reject(pieces=pieces):
            return pieces
        case typed.SetState(_, value):
            return (value,)
        case typed.Ignore():
            return ()
        case _:
            assert_never(rule)
