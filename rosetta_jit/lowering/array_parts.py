"""The parts of an expression that stand for many elements."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.lowering.layouts import ARGUMENTS
from rosetta_jit.model.expr import Binary, Call, Choice, Each, List, Path, Pick, Slice, Unary

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.model.expr import Expr


def sources_in(value: Expr) -> Iterator[Path | Call]:
    """The arrays whose elements a value is computed from: the outermost of each."""
    match value:
        case Path() | Call() if is_many(value):
            yield value
        case _:
            for inner in _inner(value):
                yield from sources_in(inner)


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


def parts_of(expr: Expr) -> Iterator[Expr]:
    """An expression and all within, but what stands in brackets."""
    yield expr
    for inner in _inner(expr):
        yield from parts_of(inner)


def _inner(expr: Expr) -> tuple[Expr, ...]:
    match expr:
        case Unary(_, operand):
            return (operand,)
        case Binary(_, left, right):
            return left, right
        case Call(_, arguments):
            return arguments
        case Choice(cases, otherwise):
            return *(part for case in cases for part in case), *(() if otherwise is None else (otherwise,))
        case List(items):
            return items
        case _:
            return ()


def substituted(expr: Expr, known: Mapping[Expr, Expr]) -> Expr:
    """An expression with others in place of some of its parts."""
    if expr in known:
        return known[expr]
    match expr:
        case Unary(_, operand):
            return replace(expr, operand=substituted(operand, known))
        case Binary(_, left, right):
            return replace(expr, left=substituted(left, known), right=substituted(right, known))
        case Call(_, arguments):
            return replace(expr, arguments=tuple(substituted(argument, known) for argument in arguments))
        case Choice(cases, otherwise):
            pairs = tuple((substituted(condition, known), substituted(value, known)) for condition, value in cases)
            return replace(expr, cases=pairs, otherwise=None if otherwise is None else substituted(otherwise, known))
        case _:
            return expr
