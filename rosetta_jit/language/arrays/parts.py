"""The parts of an expression that stand for many elements."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.arrays.layouts import ARGUMENTS
from rosetta_jit.model.expr import Call, Each, Held, Index, Path, Pick, Slice
from rosetta_jit.model.walk import rebuilt

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.model.expr import Expr


def sources_in(value: Expr) -> Iterator[Path | Call]:
    """The arrays whose elements a value is computed from: the outermost of each."""
    if isinstance(value, Path | Call) and is_many(value):
        yield value
        return
    below: list[Expr] = []
    rebuilt(value, lambda part: below.append(part) or part)
    for part in below:
        yield from sources_in(part)


def is_many(expr: Expr) -> bool:
    """Whether an expression itself names many elements."""
    match expr:
        case Path(_, steps):
            return any(isinstance(step, Slice | Pick | Each) for step in steps)
        case Call(function):
            return function in ARGUMENTS
        case _:
            return False


def has_each(expr: Expr) -> bool:
    """Whether a path has a `[]`."""
    return isinstance(expr, Path) and any(isinstance(step, Each) for step in expr.steps)


def substituted(expr: Expr, known: Mapping[Expr, Expr], number: Expr) -> Expr:
    """An expression with others in place of some of its parts; what each element of an array holds is held by that of the number."""
    if expr in known:
        return known[expr]
    if isinstance(expr, Held) and has_each(expr.place):
        steps = tuple(Index(number, step.span) if isinstance(step, Each) else step for step in expr.place.steps)
        expr = replace(expr, place=replace(expr.place, steps=steps))
    return rebuilt(expr, lambda part: substituted(part, known, number))
