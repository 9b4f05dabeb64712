"""Linear sums of integer unknowns, and whether inequalities over them can hold together.

A `Linear` is ``constant + sum(coefficient * atom)``. Atoms are numbers; what they stand for is known to `prove` alone. Everything
is exact: Python's integers do not wrap.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import gcd
from typing import NamedTuple

from rosetta_jit.startup.dataclass import dataclass

Terms = tuple[tuple[int, int], ...]
"""(atom, coefficient) pairs, by rising atom, no coefficient zero."""


class Linear(NamedTuple):
    """``constant`` plus a sum of terms."""

    constant: int
    terms: Terms = ()


sum_of: Callable[[tuple[int, Terms]], Linear] = partial(tuple[int | Terms].__new__, Linear)
"""A `Linear` of a pair, in half the time of its class: no others are made so often."""


def plus(left: Linear, right: Linear) -> Linear:
    """The sum of two."""
    constant, terms = left
    other, other_terms = right
    if not other_terms:
        return sum_of((constant + other, terms))
    if not terms:
        return sum_of((constant + other, other_terms))
    if len(other_terms) == 1 and other_terms[0][0] > terms[-1][0]:  # in order already
        return sum_of((constant + other, (*terms, *other_terms)))
    total = dict(terms)
    for atom, coefficient in other_terms:
        total[atom] = total.get(atom, 0) + coefficient
    return sum_of((constant + other, tuple(sorted([term for term in total.items() if term[1]]))))


def times(linear: Linear, factor: int) -> Linear:
    """A multiple."""
    if factor == 1:
        return linear
    if factor == 0:
        return sum_of((0, ()))
    constant, terms = linear
    return sum_of((constant * factor, tuple([(atom, coefficient * factor) for atom, coefficient in terms])))


def minus(left: Linear, right: Linear) -> Linear:
    """The difference of two: most begin with the same term, or are in order already."""
    constant, terms = left
    other, other_terms = right
    if not other_terms:
        return sum_of((constant - other, terms))
    if terms and terms[0] == other_terms[0]:
        terms, other_terms = terms[1:], other_terms[1:]
        if not other_terms:
            return sum_of((constant - other, terms))
    if len(other_terms) == 1:
        atom, coefficient = other_terms[0]
        if not terms or atom > terms[-1][0]:
            return sum_of((constant - other, (*terms, (atom, -coefficient))))
        if atom < terms[0][0]:
            return sum_of((constant - other, ((atom, -coefficient), *terms)))
    total = dict(terms)
    for atom, coefficient in other_terms:
        total[atom] = total.get(atom, 0) - coefficient
    return sum_of((constant - other, tuple(sorted([term for term in total.items() if term[1]]))))


def shifted(linear: Linear, by: int) -> Linear:
    """A constant more."""
    constant, terms = linear
    return sum_of((constant + by, terms))


def coefficient_of(linear: Linear, atom: int) -> int:
    """What an atom is multiplied by."""
    for each, coefficient in linear.terms:
        if each == atom:
            return coefficient
    return 0


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


FEW = 8
"""Facts up to which elimination leaves nothing out."""


def contradict(facts: list[Linear], budget: int) -> bool:
    """Whether inequalities ``fact >= 0`` cannot all hold, by Fourier-Motzkin elimination.

    ``budget`` bounds the combinations tried; when it is spent the answer is False, which always is the safe one. A row that was made
    from more than n + 1 of the facts after n eliminations follows from others (Kohler's rule), and among many facts is left out; as of
    equal sums only the strongest is kept, that can lose a contradiction.
    """
    rows = _Rows({fact.terms: (fact.constant, 1 << number) for number, fact in enumerate(_strongest(facts))}, {}, {})
    for terms in rows.known:
        rows.note(terms)
    eliminated, are_few = 0, len(rows.known) <= FEW
    while rows.known:
        atom, cost = rows.cheapest()
        budget -= cost
        if atom is None or budget < 0:
            return False
        eliminated += 1
        above, below = rows.taken(atom, rows.above), rows.taken(atom, rows.below)
        for terms, constant, origin, factor in above:
            for other_terms, other_constant, other_origin, other_factor in below:
                joined = origin | other_origin
                if not are_few and joined.bit_count() > eliminated + 1:
                    continue
                over, under = sum_of((constant, terms)), sum_of((other_constant, other_terms))
                row = tightened(plus(times(over, other_factor), times(under, factor)))
                if not row.terms:
                    if row.constant < 0:
                        return True
                    continue
                known = rows.known.get(row.terms)
                if known is None:
                    rows.note(row.terms)
                if known is None or known[0] > row.constant:
                    rows.known[row.terms] = row.constant, joined
    return False


_Row = tuple[Terms, int, int, int]
"""Terms, constant, the facts that it was made from (as bits), and how often the atom stands in it."""

_Side = dict[int, dict[Terms, int]]
"""For each atom the rows in which it counts up, or down, and how often."""


@dataclass(frozen=True, slots=True)
class _Rows:
    """Inequalities: what is ``known`` of sums, as a constant and the facts that it was made from, and in which of them each atom stands."""

    known: dict[Terms, tuple[int, int]]
    above: _Side
    below: _Side

    def note(self, terms: Terms) -> None:
        """A sum is there."""
        for atom, coefficient in terms:
            side = self.above if coefficient > 0 else self.below
            side.setdefault(atom, {})[terms] = abs(coefficient)

    def taken(self, atom: int, side: _Side) -> list[_Row]:
        """Take the rows out in which an atom counts up, or down."""
        found: list[_Row] = []
        for terms, factor in side.pop(atom, {}).items():
            constant, origin = self.known.pop(terms)
            found.append((terms, constant, origin, factor))
            for each, coefficient in terms:
                if each != atom:
                    del (self.above if coefficient > 0 else self.below)[each][terms]
        return found

    def cheapest(self) -> tuple[int | None, int]:
        """The atom whose elimination makes the fewest new rows, and how many combinations that takes."""
        best, least, combinations = None, 0, 0
        for atom, rows in self.above.items():
            over, under = len(rows), len(self.below.get(atom, ()))
            growth = over * under - over - under
            if over and (best is None or growth < least):
                best, least, combinations = atom, growth, over * under
        for atom, rows in self.below.items():
            if rows and not self.above.get(atom) and (best is None or -len(rows) < least):
                best, least, combinations = atom, -len(rows), 0
        return best, combinations


def _strongest(facts: list[Linear]) -> list[Linear]:
    """Of facts about the same sum the one that says most."""
    best: dict[Terms, int] = {}
    for constant, terms in facts:
        if terms not in best or best[terms] > constant:
            best[terms] = constant
    return [sum_of((constant, terms)) for terms, constant in best.items()]
