r"""What is known at one place of a kernel, and what follows from it.

`Facts` keeps, for each sum of atoms, the greatest lower bound that is known. Most questions are answered by a look at that table or by the
bounds of single atoms, nearly all others by adding up one or two facts; the rest by Fourier-Motzkin elimination on the facts around the
question, within a budget. A No means "not proven".

Facts are gained along a path and given up at its end (`mark`, `rollback`), so that the two branches of an If share one table.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Literal, NamedTuple, assert_never

from rosetta_jit.kernel.limits import MAX_CASES, MAX_PROPAGATED, MAX_TRIED
from rosetta_jit.kernel.proof.formula import All, Any, Formula, equal, is_vague, negated, said, shares_atom
from rosetta_jit.kernel.proof.linear import Linear, Terms, coefficient_of, contradict, minus, replaced, shifted, sum_of, tightened, times
from rosetta_jit.startup.dataclass import dataclass, field


class Effort(NamedTuple):
    """How far a proof may go: facts that it adds up, facts among which it eliminates atoms, and how many of those it may combine."""

    summands: int
    facts: int
    combinations: int


GLANCE, SUMS, QUICK, THOROUGH = Effort(0, 0, 0), Effort(2, 0, 0), Effort(2, 32, 300), Effort(4, 96, 4000)
"""For what stands in the table, for what takes no elimination, for a question, and for an obligation."""

Procedure = Literal["constants", "unreachable", "bounds", "sums", "elimination", "cases", "operations", "paths"]
"""Who proves: a look at constants, the contradiction of what a path takes as known, the table of bounds, a sum of few facts,
Fourier-Motzkin elimination, or that in each case of a choice. What the proof infers comes from the rules of operations (`integers`) and
from where paths meet (`paths`)."""

_UNITS = (1, -1)
"""Coefficients that have no common factor with others."""


@dataclass(slots=True)
class Facts:
    """Bounds of atoms and of sums of atoms."""

    lows: list[int] = field(default_factory=list[int])
    highs: list[int] = field(default_factory=list[int])
    impossible: bool = False
    _bounds: dict[Terms, int] = field(default_factory=dict[Terms, int])
    _about: dict[int, list[Terms]] = field(default_factory=dict[int, list[Terms]])
    _cases: dict[int, tuple[tuple[Formula, Linear], ...]] = field(default_factory=dict[int, tuple[tuple[Formula, Linear], ...]])
    _named: dict[Hashable, Linear] = field(default_factory=dict[Hashable, Linear])
    _born: list[tuple[int, int]] = field(default_factory=list[tuple[int, int]])
    _either: dict[Any, None] = field(default_factory=dict[Any, None])
    _trail: list[tuple[str, int | Terms, int | None]] = field(default_factory=list[tuple[str, "int | Terms", "int | None"]])

    # --- atoms -------------------------------------------------------------------------------------------------------

    def fresh(self, low: int, high: int) -> Linear:
        """A new atom between two bounds."""
        self.lows.append(low)
        self.highs.append(high)
        self._born.append((low, high))
        return sum_of((0, ((len(self.lows) - 1, 1),)))

    def named(self, key: Hashable, low: int, high: int) -> Linear:
        """The atom of a term that linear reasoning cannot look into; the same term is the same atom. The bounds hold on every path."""
        atom = self._named.get(key)
        if atom is None:
            atom = self._named[key] = self.fresh(low, high)
        return atom

    def has(self, key: Hashable) -> bool:
        """Whether a term has an atom."""
        return key in self._named

    def born(self, atom: int) -> tuple[int, int]:
        """Bounds of an atom on every path where it exists."""
        return self._born[atom]

    def chosen(self, cases: tuple[tuple[Formula, Linear], ...]) -> Linear:
        """The atom that is equal to one of some values, each under a condition; together they cover everything.

        The same choice is the same atom, unless nothing is known of its conditions: then two that look the same may differ.
        """
        widest = [self.widest(value) for _, value in cases]
        low, high = min(low for low, _ in widest), max(high for _, high in widest)
        atom = self.fresh(low, high) if any(is_vague(condition) for condition, _ in cases) else self.named(cases, low, high)
        self._cases[atom.terms[0][0]] = cases
        self._take(shifted(atom, -min(self.lower(value) for _, value in cases)))
        self._take(shifted(times(atom, -1), max(self.upper(value) for _, value in cases)))
        return atom

    def widest(self, linear: Linear) -> tuple[int, int]:
        """Bounds of a sum on every path."""
        low = high = linear.constant
        for atom, coefficient in linear.terms:
            ends = [coefficient * end for end in self._born[atom]]
            low, high = low + min(ends), high + max(ends)
        return low, high

    def abbreviated(self, value: Linear, low: int, high: int) -> Linear:
        """A new atom that stands for a sum of which the bounds are known."""
        atom = self.fresh(low, high)
        self._take(equal(atom, value))
        return atom

    # --- learning ----------------------------------------------------------------------------------------------------

    def _take(self, formula: Formula) -> None:
        """Take a formula as known."""
        match formula:
            case Linear():
                self._learn(formula)
            case All(parts):
                for part in parts:
                    self._take(part)
            case Any() if is_vague(formula):
                self._take(said(formula))
            case Any(parts):
                # Without looking at cases: a case may have alternatives of its own, and theirs again.
                open_parts = [part for part in parts if not self._proves(negated(part), 0, QUICK)]
                if len(open_parts) == 1:
                    self._take(open_parts[0])
                elif not open_parts:
                    self._contradiction()
                elif formula not in self._either:
                    self._trail.append(("either", 0, None))
                    self._either[formula] = None
            case False:
                self._contradiction()
            case True | None:
                pass
            case _:
                assert_never(formula)

    assume = _take
    """Take as known what is given: what a check has found, which branch was taken, what a loop keeps."""
    derive = _take
    """Take as known what follows from what is known already and from what the atoms stand for."""

    def _learn(self, fact: Linear) -> None:
        constant, terms = fact
        if len(terms) == 1:
            self._learn_bound(constant, *terms[0])
        elif terms:
            if terms[0][1] not in _UNITS:
                constant, terms = tightened(fact)
            known = self._bounds.get(terms)
            if known is None or known < -constant:
                self._trail.append(("sum", terms, known))
                self._bounds[terms] = -constant
                if known is None:
                    for atom, _ in terms:
                        self._about.setdefault(atom, []).append(terms)
                self._propagate(constant, terms)
        elif constant < 0:
            self._contradiction()

    def _propagate(self, constant: int, terms: Terms) -> None:
        """Bound each atom of a short sum by the bounds of the others, so that most questions need no more than bounds."""
        if len(terms) > MAX_PROPAGATED:
            return
        lows, highs = self.lows, self.highs
        greatest = [c * (highs[a] if c > 0 else lows[a]) for a, c in terms]
        total = constant + sum(greatest)
        for (atom, coefficient), own in zip(terms, greatest, strict=True):
            rest = total - own
            if rest + coefficient * (lows if coefficient > 0 else highs)[atom] < 0:  # else that is known
                self._learn_bound(rest, atom, coefficient)

    def _learn_bound(self, constant: int, atom: int, coefficient: int) -> None:
        if coefficient > 0:
            low = -(constant // coefficient)
            if low > self.lows[atom]:
                self._trail.append(("low", atom, self.lows[atom]))
                self.lows[atom] = low
        else:
            high = constant // -coefficient
            if high < self.highs[atom]:
                self._trail.append(("high", atom, self.highs[atom]))
                self.highs[atom] = high
        if self.lows[atom] > self.highs[atom]:
            self._contradiction()

    def _contradiction(self) -> None:
        if not self.impossible:
            self._trail.append(("impossible", 0, None))
            self.impossible = True

    # --- paths -------------------------------------------------------------------------------------------------------

    def mark(self) -> int:
        """A point to roll back to."""
        return len(self._trail)

    def rollback(self, mark: int) -> dict[Terms, int]:
        """Give up what was learnt since a mark; returns it, as lower bounds of sums."""
        gained: dict[Terms, int] = {}
        while len(self._trail) > mark:
            kind, key, old = self._trail.pop()
            if isinstance(key, tuple):
                gained.setdefault(key, self._bounds[key])
                self._forget(key, old)
            elif kind == "impossible":
                self.impossible = False
            elif kind == "either":
                self._either.popitem()
            elif kind == "low" and old is not None:
                gained.setdefault(((key, 1),), self.lows[key])
                self.lows[key] = old
            elif old is not None:
                gained.setdefault(((key, -1),), -self.highs[key])
                self.highs[key] = old
        return gained

    def _forget(self, key: Terms, old: int | None) -> None:
        if old is not None:
            self._bounds[key] = old
            return
        del self._bounds[key]
        for atom, _ in key:
            self._about[atom].pop()

    # --- asking ------------------------------------------------------------------------------------------------------

    def lower(self, linear: Linear) -> int:
        """A lower bound, by a look at the table."""
        total = linear.constant
        for atom, coefficient in linear.terms:
            total += coefficient * (self.lows[atom] if coefficient > 0 else self.highs[atom])
        known = self._bounds.get(linear.terms)
        return total if known is None else max(total, known + linear.constant)

    def is_shown(self, linear: Linear) -> bool:
        """Whether a lower bound of 0 stands in the table."""
        total, terms = linear
        for atom, coefficient in terms:
            total += coefficient * (self.lows[atom] if coefficient > 0 else self.highs[atom])
        return total >= 0 or ((known := self._bounds.get(terms)) is not None and known + linear.constant >= 0)

    def upper(self, linear: Linear) -> int:
        """An upper bound, by a look at the table."""
        return -self.lower(times(linear, -1))

    def ends(self, linear: Linear) -> tuple[int, int]:
        """A lower bound of a sum, and one of its opposite, by a look at the table."""
        constant, terms = linear
        low, opposite = constant, -constant
        for atom, coefficient in terms:
            below, above = (self.lows[atom], self.highs[atom]) if coefficient > 0 else (self.highs[atom], self.lows[atom])
            low, opposite = low + coefficient * below, opposite - coefficient * above
        known, other = self._bounds.get(terms), self._bounds.get(tuple([(atom, -coefficient) for atom, coefficient in terms]))
        return low if known is None else max(low, known + constant), opposite if other is None else max(opposite, other - constant)

    def lies_within(self, linear: Linear, low: int, high: int) -> bool:
        """Whether the bounds of its atoms show that a sum lies between two numbers."""
        least = greatest = linear.constant
        for atom, coefficient in linear.terms:
            below, above = (self.lows[atom], self.highs[atom]) if coefficient > 0 else (self.highs[atom], self.lows[atom])
            least, greatest = least + coefficient * below, greatest + coefficient * above
        return low <= least and greatest <= high

    def sums_about(self, atom: int, most: int) -> list[Linear]:
        """Some facts (each >= 0) that name an atom among others."""
        return [sum_of((-self._bounds[terms], terms)) for terms in self._about.get(atom, ())[:most]]

    def shows(self, formula: Formula) -> bool:
        """Whether a formula stands in the table: to assume it would add nothing."""
        return self.impossible or self._proves(formula, 0, GLANCE)

    def adds_up(self, formula: Formula) -> bool:
        """Whether a formula is a sum of one or two facts: of what a look at the table does not show, most is, and that is quickly found."""
        return self.impossible or self._proves(formula, 0, SUMS)

    def proves(self, formula: Formula) -> bool:
        """Whether a formula follows from what is known, as far as a short look shows."""
        return self.impossible or self._proves(formula, MAX_CASES, QUICK)

    def proves_thoroughly(self, formula: Formula) -> bool:
        """Whether a formula follows from what is known: for what ought to, as a No may take long."""
        return self.proves(formula) or self._proves(formula, MAX_CASES, THOROUGH)

    def procedure(self, formula: Formula) -> Procedure | None:
        """The simplest procedure that proves a formula; None where it is not proven."""
        if formula is True or (isinstance(formula, Linear) and not formula.terms and formula.constant >= 0):
            return "constants"
        if self.impossible:
            return "unreachable"
        if self._proves(formula, 0, GLANCE):
            return "bounds"
        if self._proves(formula, 0, SUMS):
            return "sums"
        if self._proves(formula, 0, THOROUGH):
            return "elimination"
        return "cases" if self.proves_thoroughly(formula) else None

    def _proves(self, formula: Formula, depth: int, effort: Effort) -> bool:
        match formula:
            case Linear():
                if self.is_shown(formula):
                    return True
                return (effort.summands > 0 and self._follows(formula, effort)) or (depth > 0 and self._by_cases(formula, depth, effort))
            case All(parts):
                return all(self._proves(part, depth, effort) for part in parts)
            case Any(parts):
                # An alternative that a look shows comes before elimination on another one.
                return (
                    (bool(self._either) and formula in self._either)
                    or (effort.facts > 0 and any(self._proves(part, 0, SUMS) for part in parts))
                    or any(self._proves(part, depth, effort) for part in parts)
                    or self._proves_one(parts, depth, effort)
                )
            case bool():
                return formula
            case None:
                return False
            case _:
                assert_never(formula)

    def _proves_one(self, parts: tuple[Formula, ...], depth: int, effort: Effort) -> bool:
        """Whether the last part holds where all others do not."""
        if depth == 0 or len(parts) < 2:
            return False
        mark = self.mark()
        for part in parts[:-1]:
            self._take(negated(part))
        proven = self.impossible or self._proves(parts[-1], depth - 1, effort)
        self.rollback(mark)
        return proven

    def _by_cases(self, goal: Linear, depth: int, effort: Effort) -> bool:
        """Whether a goal holds in each case of an atom that is chosen among values, or of a fact that has alternatives.

        The youngest atom comes first: what it is chosen among may rest on the others.
        """
        atom = max((a for a, _ in goal.terms if a in self._cases), default=None)
        if atom is not None:
            return all(self._in_case(replaced(goal, atom, value), condition, depth, effort) for condition, value in self._cases[atom])
        alternatives = next((fact for fact in reversed(self._either) if shares_atom(fact, goal)), None)
        return alternatives is not None and all(self._in_case(goal, part, depth, effort) for part in alternatives.parts)

    def _in_case(self, goal: Linear, condition: Formula, depth: int, effort: Effort) -> bool:
        mark = self.mark()
        self._take(condition)
        proven = self.impossible or self._proves(goal, depth - 1, effort)
        self.rollback(mark)
        return proven

    def _follows(self, goal: Linear, effort: Effort) -> bool:
        """Whether a goal is a sum of facts, or the facts around it contradict its opposite."""
        if self._is_sum(goal, effort.summands):
            return True
        nearby = self._nearby(goal, effort.facts) if effort.facts else None
        return bool(nearby) and contradict([*nearby, shifted(times(goal, -1), -1)], effort.combinations)

    def _is_sum(self, goal: Linear, most: int) -> bool:
        """Whether a goal is a sum of at most so many facts, or multiples of them, and of something that bounds show.

        Each fact must do away with an atom: of those whose own bound does not help the goal, the one of which the fewest facts are known.
        """
        about = [
            (wanted * (self.lows[atom] if wanted > 0 else self.highs[atom]) >= 0, len(facts), atom, wanted)
            for atom, wanted in goal.terms
            if (facts := self._about.get(atom))
        ]
        if not about:
            return False
        *_, atom, wanted = min(about)
        for terms in self._about[atom][: -1 - MAX_TRIED : -1]:
            fact = sum_of((-self._bounds[terms], terms))
            factor, left = divmod(wanted, coefficient_of(fact, atom))
            if left or factor < 0:
                continue
            rest = minus(goal, times(fact, factor))
            if self.lower(rest) >= 0 or (most > 1 and self._is_sum(rest, most - 1)):
                return True
        return False

    def _nearby(self, goal: Linear, most: int) -> list[Linear]:
        """Facts that share atoms with a goal, and facts that share atoms with those.

        The youngest atom comes first: of an old one, such as a lane's capacity, very many facts may be known.
        """
        sums: dict[Terms, None] = {}
        atoms = dict.fromkeys(atom for atom, _ in reversed(goal.terms))
        queue = list(atoms)
        while queue and len(sums) < most:
            for terms in reversed(self._about.get(queue.pop(0), ())):
                if terms in sums:
                    continue
                sums[terms] = None
                queue.extend(a for a, _ in terms if a not in atoms)
                atoms.update(dict.fromkeys(a for a, _ in terms))
                if len(sums) >= most:
                    break
        if not sums:
            return []
        known = [sum_of((-self._bounds[terms], terms)) for terms in sums]
        lows = [sum_of((-self.lows[atom], ((atom, 1),))) for atom in atoms]
        return known + lows + [sum_of((self.highs[atom], ((atom, -1),))) for atom in atoms]
