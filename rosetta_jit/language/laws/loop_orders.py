"""Elements in another order: the round of one loop nest that set what a round of another reads.

The first direction sets `.b[W]` to `.a[E]` in loops over `v`, the second one reads `.b[I]` in loops over `s`. Where each `v` counts as
one of the `s`, up or down, over as many numbers, and `W` then is `I`, what is read is `.a[E]` in the round of those `v`: transpositions,
planar and interleaved channels. As each place is set once, no other round can have set it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.language.algebra.polynomial import (
    Polynomial,
    TooComplexError,
    atom,
    coefficient_of,
    contains,
    number,
    polynomial_of,
    substitute,
    subtract,
)
from rosetta_jit.language.algebra.quotients import Facts, are_same
from rosetta_jit.language.limits import MAX_LOOPS
from rosetta_jit.language.typed import INT64, Binary, Const, Expr, IndexStep, Local, Place

if TYPE_CHECKING:
    from rosetta_jit.language.algebra.equality import Ranges


Strides = tuple["Polynomial", ...]
"""How far each index of a place goes with each number of a loop."""

PREFIX = "§"
"""What the numbers of the first loops are called while both are compared."""


def round_of(write: Place, ranges: Ranges, read: Place, around: Ranges, facts: Facts) -> dict[str, Expr] | None:
    """The numbers of the loops over ``ranges`` around a rule in the round that sets what is read in loops over ``around``."""
    if not 1 < len(ranges) <= len(around) <= MAX_LOOPS or len(write.steps) != len(read.steps):
        return None
    pairs = list(zip(write.steps, read.steps, strict=True))
    if any(left != right for left, right in pairs if not (isinstance(left, IndexStep) and isinstance(right, IndexStep))):
        return None
    try:
        return _round(_numbers(write), _numbers(read), ranges, around, facts)
    except TooComplexError:
        return None


def _numbers(place: Place) -> list[Polynomial]:
    return [polynomial_of(step.index) for step in place.steps if isinstance(step, IndexStep)]


def _round(writes: list[Polynomial], reads: list[Polynomial], ranges: Ranges, around: Ranges, facts: Facts) -> dict[str, Expr] | None:
    found: dict[str, Expr] = {}
    taken: set[int] = set()
    for number_, range_ in enumerate(ranges):
        strides = _strides(writes, f"${number_}")
        if strides is None:
            return None
        for other, expr in _alike(strides, range_, reads, around, facts):
            if other not in taken:
                taken.add(other)
                found[f"${number_}"] = expr
                break
        else:
            return None
    set_ = [_put(each, found) for each in writes]
    return found if all(are_same(one, other, facts) for one, other in zip(set_, reads, strict=True)) else None


def _strides(indices: list[Polynomial], name: str) -> Strides | None:
    """How the indices depend on the number of a loop; None where they do not, or otherwise than in proportion."""
    parts = [coefficient_of(index, name) for index in indices]
    strides = tuple(part[0] for part in parts if part is not None)
    return strides if len(strides) == len(parts) and any(each != number(0) for each in strides) else None


def _alike(
    strides: Strides, range_: tuple[Expr, Expr], reads: list[Polynomial], around: Ranges, facts: Facts
) -> Iterator[tuple[int, Expr]]:
    """The loops that count as one does, up or down, and its number in terms of theirs."""
    for number_, (start, stop) in enumerate(around):
        theirs = _strides(reads, f"${number_}")
        if theirs is None or not (_same(range_[0], start, facts) and _same(range_[1], stop, facts)):
            continue
        if all(are_same(one, other, facts) for one, other in zip(strides, theirs, strict=True)):
            yield number_, Local(f"${number_}")
        elif start == Const(0, INT64) and all(
            are_same(one, subtract(number(0), other), facts) for one, other in zip(strides, theirs, strict=True)
        ):
            last = Binary("-", stop, Const(1, INT64), INT64)
            yield number_, Binary("-", last, Local(f"${number_}"), INT64)


def _same(left: Expr, right: Expr, facts: Facts) -> bool:
    """Whether two bounds of loops are the same in all rounds."""
    pair = polynomial_of(left), polynomial_of(right)
    return not any(contains(each, f"${number_}") for each in pair for number_ in range(MAX_LOOPS)) and are_same(*pair, facts)


def _put(index: Polynomial, found: dict[str, Expr]) -> Polynomial:
    """An index with what the numbers of its loops are in their places, all at once: both nests call theirs the same."""
    for name in found:
        index = substitute(index, name, atom(PREFIX + name))
    for name, value in found.items():
        index = substitute(index, PREFIX + name, polynomial_of(value))
    return index
