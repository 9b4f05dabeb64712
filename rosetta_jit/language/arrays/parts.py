"""The parts of an expression that stand for many elements.

A reduction, `sum(.a[])`, is one value: the `[]` within it are its own, and no rule around it is meant for each of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rosetta_jit.language.arrays.array_functions import ARGUMENTS
from rosetta_jit.language.installed import written
from rosetta_jit.model.expr import Call, Coerced, Each, Expr, Index, Len, Path, Pick, Slice
from rosetta_jit.model.walk import parts, rebuilt
from rosetta_jit.startup.dataclass import replace

NUMBER = Call("index", ())
"""The number of the element that a rule for each of them is at."""


def sources_in(value: Expr) -> Iterator[Path | Call]:
    """The arrays whose elements a value is computed from: the outermost of each."""
    if is_reduction(value):
        return
    if isinstance(value, Path | Call) and is_many(value):
        yield value
        return
    if isinstance(value, Len) and has_each(value.path):
        yield value.path
        return
    below: list[Expr] = []
    rebuilt(value, lambda part: below.append(part) or part)
    for part in below:
        yield from sources_in(part)


def open_parts(expr: Expr) -> Iterator[Expr]:
    """Every part of an expression, itself first, but for what is within reductions."""
    yield expr
    if is_reduction(expr):
        return
    below: list[Expr] = []
    rebuilt(expr, lambda part: below.append(part) or part)
    for part in below:
        yield from open_parts(part)


def is_reduction(expr: Expr) -> bool:
    """Whether an expression makes one value of many."""
    if not (isinstance(expr, Call) and len(expr.arguments) == 1):
        return False
    function = written(expr.function)
    return function is not None and function.reduction is not None and any(map(is_many, parts(expr.arguments[0])))


def is_many(expr: Expr) -> bool:
    """Whether an expression itself names many elements."""
    match expr:
        case Path(_, steps):
            return any(isinstance(step, Slice | Pick | Each) for step in steps)
        case Len(path):
            return has_each(path)
        case Call(function):
            return function in ARGUMENTS
        case _:
            return False


def has_each(expr: Expr) -> bool:
    """Whether a path, or one whose length is asked for, has a `[]`."""
    if isinstance(expr, Len):
        return has_each(expr.path)
    return isinstance(expr, Path) and any(isinstance(step, Each) for step in expr.steps)


def substituted(expr: Expr, known: Mapping[Expr, Expr], number: Expr) -> Expr:
    """An expression with others in place of some of its parts; what each element of an array holds is held by that of the number."""
    if expr in known:
        return known[expr]
    if is_reduction(expr):
        return expr
    if expr == NUMBER:
        return number
    if isinstance(expr, Len) and isinstance(element := known.get(expr.path), Path):
        return replace(expr, path=element)
    if isinstance(expr, Coerced) and has_each(expr.place):
        steps = tuple(Index(number, step.span) if isinstance(step, Each) else step for step in expr.place.steps)
        expr = replace(expr, place=replace(expr.place, steps=steps))
    return rebuilt(expr, lambda part: substituted(part, known, number))
