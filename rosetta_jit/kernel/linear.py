"""Linear sums of integer unknowns, and whether inequalities over them can hold together.

A `Linear` is ``constant + sum(coefficient * atom)``. Atoms are numbers; what they stand for is known to `prove` alone. Everything
is exact: Python's integers do not wrap.
"""

from __future__ import annotations

from math import gcd
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable

Terms = tuple[tuple[int, int], ...]
"""(atom, coefficient) pairs, by rising atom, no coefficient zero."""


class Linear(NamedTuple):
    """``constant`` plus a sum of terms."""

    constant: int
    terms: Terms = ()


def plus(left: Linear, right: Linear) -> Linear:
    """The sum of two."""
    if not right.terms:
        return Linear(left.constant + right.constant, left.terms)
    if not left.terms:
        return Linear(left.constant + right.constant, right.terms)
    total = dict(left.terms)
    for atom, coefficient in right.terms:
        total[atom] = total.get(atom, 0) + coefficient
    return Linear(left.constant + right.constant, _terms(total))


def times(linear: Linear, factor: int) -> Linear:
    """A multiple."""
    if factor == 0:
        return Linear(0)
    return Linear(linear.constant * factor, tuple((a, c * factor) for a, c in linear.terms))


def minus(left: Linear, right: Linear) -> Linear:
    """The difference of two."""
    if not right.terms:
        return Linear(left.constant - right.constant, left.terms)
    return plus(left, times(right, -1))


def shifted(linear: Linear, by: int) -> Linear:
    """A constant more."""
    return Linear(linear.constant + by, linear.terms)


def coefficient_of(linear: Linear, atom: int) -> int:
    """What an atom is multiplied by."""
    return next((c for a, c in linear.terms if a == atom), 0)


def replaced(linear: Linear, atom: int, value: Linear) -> Linear:
    """The sum with a value in place of an atom."""
    coefficient = coefficient_of(linear, atom)
    rest = Linear(linear.constant, tuple(term for term in linear.terms if term[0] != atom))
    return plus(rest, times(value, coefficient))


def tightened(linear: Linear) -> Linear:
    """The same fact ``linear >= 0`` over integers, with coefficients without a common factor."""
    common = 0
    for _, coefficient in linear.terms:
        common = gcd(common, coefficient)
        if common == 1:
            return linear
    if common == 0:
        return linear
    # floor: sum >= -constant/common, and the sum is an integer
    return Linear(linear.constant // common, tuple((a, c // common) for a, c in linear.terms))


def contradict(facts: list[Linear], budget: int) -> bool:
    """Whether inequalities ``fact >= 0`` cannot all hold, by Fourier-Motzkin elimination.

    ``budget`` bounds the combinations tried; when it is spent the answer is False, which always is the safe one.
    """
    rows = _strongest((fact.constant, dict(fact.terms)) for fact in facts)
    while rows:
        if any(constant < 0 and not terms for constant, terms in rows):
            return True
        atom = _cheapest(rows)
        if atom is None:
            return False
        above = [row for row in rows if row[1].get(atom, 0) > 0]
        below = [row for row in rows if row[1].get(atom, 0) < 0]
        budget -= len(above) * len(below)
        if budget < 0:
            return False
        rows = [row for row in rows if atom not in row[1]]
        if above and below:
            rows = _strongest([*rows, *(_combined(over, under, atom) for over in above for under in below)])
    return False


_Row = tuple[int, dict[int, int]]
"""Constant and coefficients by atom, none of them zero: quicker to combine than a `Linear`."""


def _cheapest(rows: list[_Row]) -> int | None:
    """The atom whose elimination makes the fewest new rows."""
    above: dict[int, int] = {}
    below: dict[int, int] = {}
    for _, terms in rows:
        for atom, coefficient in terms.items():
            side = above if coefficient > 0 else below
            side[atom] = side.get(atom, 0) + 1
    best, least = None, 0
    for atom in sorted(above.keys() | below.keys()):
        over, under = above.get(atom, 0), below.get(atom, 0)
        cost = over * under - over - under
        if best is None or cost < least:
            best, least = atom, cost
    return best


def _combined(over: _Row, under: _Row, atom: int) -> _Row:
    """The consequence of two facts in which the atom cancels."""
    up, down = -under[1][atom], over[1][atom]
    total = {each: coefficient * up for each, coefficient in over[1].items()}
    for each, coefficient in under[1].items():
        total[each] = total.get(each, 0) + coefficient * down
    terms = {each: coefficient for each, coefficient in total.items() if coefficient}
    constant, common = over[0] * up + under[0] * down, gcd(*terms.values())
    if common > 1:
        return constant // common, {each: coefficient // common for each, coefficient in terms.items()}
    return constant, terms


def _strongest(rows: Iterable[_Row]) -> list[_Row]:
    """Of facts about the same sum the one that says most."""
    best: dict[frozenset[tuple[int, int]], _Row] = {}
    for row in rows:
        key = frozenset(row[1].items())
        known = best.get(key)
        if known is None or row[0] < known[0]:
            best[key] = row
    return list(best.values())


def _terms(total: dict[int, int]) -> Terms:
    return tuple(sorted((atom, coefficient) for atom, coefficient in total.items() if coefficient))
