"""What rules write, as data for the checks: place by place, the indices as polynomials, with the loops around."""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.catalogue import check as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.algebra.polynomial import (
    Polynomial,
    TooComplexError,
    add,
    atom,
    coefficient_of,
    contains,
    number,
    polynomial_of,
    substitute,
    subtract,
)
from rosetta_jit.language.check.tiling import Dimension, Run
from rosetta_jit.language.places import field_names, places_in
from rosetta_jit.language.typed import Assign, Default, Expr, FieldStep, For, Ignore, Place, Reject, Rule, SetLength, SetState, When
from rosetta_jit.model.rules import Kept
from rosetta_jit.model.types import Field
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace


@dataclass(frozen=True, slots=True)
class Loop:
    """A loop around a write: ``variable`` counts from ``start``, ``count`` times."""

    variable: str
    start: Polynomial
    count: Polynomial


@dataclass(frozen=True, slots=True)
class Write:
    """One rule's effect, seen from some place: the steps that remain below it and the loops not yet used by an index.

    ``value`` is None where the rule sets a length, which is ``length`` then, or leaves the place alone.
    """

    steps: tuple[Field | Polynomial, ...]
    loops: tuple[Loop, ...]
    value: Expr | None
    length: Polynomial | None
    span: Span | None

    def below(self) -> Write:
        """The same write seen from one step further down."""
        return replace(self, steps=self.steps[1:])


def writes_of(
    rules: tuple[Rule, ...], problems: list[Diagnostic], broken: set[tuple[str, ...]], loops: tuple[Loop, ...] = ()
) -> list[Write]:
    """All writes of a block without `when`s, in order; a rule that is too complex is reported, and what it sets is ``broken``."""
    found: list[Write] = []
    for rule in rules:
        try:
            match rule:
                case Assign(place, value, span):
                    found.append(Write(_steps(place), loops, value, None, span))
                case Default(place, span):
                    found.append(Write(_steps(place), loops, None, None, span))
                case Ignore() | SetState():
                    pass
                case SetLength(place, value, span):
                    found.append(Write(_steps(place), loops, None, polynomial_of(value), span))
                case For(body=body, kept=Kept(variable=variable, count=count)) if count is not None:
                    loop = Loop(variable, number(0), polynomial_of(count))
                    found += writes_of(body, problems, broken, (*loops, loop))
                case For(variable, start, stop, body):
                    first = polynomial_of(start)
                    loop = Loop(variable, first, subtract(polynomial_of(stop), first))
                    found += writes_of(body, problems, broken, (*loops, loop))
                case When() | Reject():
                    raise AssertionError(rule)
                case _:
                    assert_never(rule)
        except TooComplexError:
            problems.append(words.too_complex(rule.span))
            broken.update(field_names(place) for place in places_in((rule,)))
    return found


def _steps(place: Place) -> tuple[Field | Polynomial, ...]:
    return tuple(step.field if isinstance(step, FieldStep) else polynomial_of(step.index) for step in place.steps)


def enter(write: Write, level: int) -> tuple[Run, Write] | None:
    """The elements that a write sets, and the write seen from one of them; None if its index is not affine.

    Loop variables that the index uses are counted from their start and renamed by ``level``, so that writes of other
    loops over the same elements look the same.
    """
    index, seen = write.steps[0], write.below()
    if not isinstance(index, Polynomial):
        return None
    used: tuple[Loop, ...] = ()
    for loop in reversed(write.loops):
        if contains(index, loop.variable):
            name = f"${level}.{len(used)}"
            value = add(loop.start, atom(name))
            index = substitute(index, loop.variable, value)
            used = _renamed_loops((*used, replace(loop, variable=name)), loop.variable, value)
            seen = _renamed(seen, loop.variable, value)
    strides = _strides(index, used)
    if strides is None:
        return None
    start, dimensions = strides
    return Run(start, number(1), dimensions, write.span), seen


def _strides(index: Polynomial, used: tuple[Loop, ...]) -> tuple[Polynomial, tuple[Dimension, ...]] | None:
    dimensions: list[Dimension] = []
    for loop in used:
        affine = coefficient_of(index, loop.variable)
        if affine is None or any(contains(part, other.variable) for part in (affine[0], loop.count) for other in used):
            return None
        dimensions.append((affine[0], loop.count))
        index = affine[1]
    return index, tuple(dimensions)


def _renamed(write: Write, variable: str, value: Polynomial) -> Write:
    steps = tuple(substitute(step, variable, value) if isinstance(step, Polynomial) else step for step in write.steps)
    loops = tuple(loop for loop in write.loops if loop.variable != variable)
    length = None if write.length is None else substitute(write.length, variable, value)
    return replace(write, steps=steps, loops=_renamed_loops(loops, variable, value), length=length)


def _renamed_loops(loops: tuple[Loop, ...], variable: str, value: Polynomial) -> tuple[Loop, ...]:
    return tuple(Loop(loop.variable, substitute(loop.start, variable, value), substitute(loop.count, variable, value)) for loop in loops)
