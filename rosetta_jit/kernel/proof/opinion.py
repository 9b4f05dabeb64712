"""An independent opinion on a kernel's obligations: z3 judges whether each follows from its premises.

z3 is given what the proof was given, not what it concluded: the premises as they were said, the ranges of unknowns, and what the atoms of
operations stand for (`meanings`). Facts that the proof itself infers are premises of what comes after them, and obligations themselves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import takewhile
from typing import Literal

import z3

from rosetta_jit.kernel.limits import MAX_Z3_STEPS
from rosetta_jit.kernel.proof import claims
from rosetta_jit.kernel.proof.formula import Formula
from rosetta_jit.kernel.proof.meanings import Terms, atoms_in
from rosetta_jit.kernel.proof.record import Obligation, Premise, RecordedFacts, chain
from rosetta_jit.startup.dataclass import dataclass, field

Verdict = Literal["proved", "refuted", "unknown"]


@dataclass(frozen=True, slots=True)
class Opinion:
    """What z3 says of an obligation; where it is refuted, values of the atoms in it that do."""

    verdict: Verdict
    counterexample: tuple[tuple[str, int], ...] = ()


def opinions(obligations: Iterable[Obligation]) -> Iterator[Opinion]:
    """z3's opinion on each obligation."""
    judge: _Judge | None = None
    for obligation in obligations:
        if judge is None or judge.facts is not obligation.facts:
            judge = _Judge(obligation.facts)
        yield judge.opinion(obligation)


@dataclass(slots=True)
class _Level:
    """A premise on the solver's stack, the atoms whose ranges it came with, and the claims that follow there."""

    premise: Premise
    atoms: set[int]
    proven: set[Formula] = field(default_factory=set["Formula"])


class _Judge:
    """z3 with the premises of a place of a kernel, most of which the next place has, too."""

    def __init__(self, facts: RecordedFacts) -> None:
        self.facts = facts
        self._terms = Terms(facts)
        self._solver = _solver()
        self._levels: list[_Level] = []

    def opinion(self, obligation: Obligation) -> Opinion:
        """What the premises say alone, which is linear; where that does not tell, with what the atoms stand for."""
        if isinstance(obligation.formula, bool) and obligation.procedure == "constants":
            return Opinion("proved" if obligation.formula else "refuted")
        if obligation.claim is not claims.OPERATION and self._follows(obligation):
            return Opinion("proved")
        as_bits = any(map(self._terms.is_bitwise, atoms_in(obligation.formula)))
        return self._afresh(obligation, Terms(self.facts, as_bits=True) if as_bits else self._terms)

    def _follows(self, obligation: Obligation) -> bool:
        """Whether a claim follows from its premises, as linear sums. What follows from some of them follows from all."""
        self._go_to(obligation)
        if any(obligation.formula in level.proven for level in self._levels):
            return True
        self._solver.push()
        self._tell_ranges(atoms_in(obligation.formula), obligation.claimed_atoms)
        self._solver.add(z3.Not(self._terms.claimed(obligation.formula)))
        found = self._solver.check()
        self._solver.pop()
        if found == z3.unsat and self._levels:
            self._levels[-1].proven.add(obligation.formula)
        return found == z3.unsat

    def _go_to(self, obligation: Obligation) -> None:
        """Give the solver the premises of an obligation: what differs from those of the last one."""
        depth = {id(level.premise): number for number, level in enumerate(self._levels)}
        wanted = list(takewhile(lambda premise: id(premise) not in depth, chain(obligation.premises)))
        shared = wanted[-1].before if wanted else obligation.premises
        keep = 0 if shared is None else depth[id(shared)] + 1
        if keep < len(self._levels):
            self._solver.pop(len(self._levels) - keep)
            del self._levels[keep:]
        for premise in reversed(wanted):
            self._solver.push()
            self._levels.append(_Level(premise, self._tell_ranges(atoms_in(premise.formula), obligation.claimed_atoms)))
            self._solver.add(self._terms.said(premise.formula))

    def _tell_ranges(self, atoms: set[int], claimed_atoms: int) -> set[int]:
        """Tell the solver the ranges of atoms that it does not know yet, but for those that are claimed."""
        new = {atom for atom in atoms if atom < claimed_atoms}.difference(*(level.atoms for level in self._levels))
        self._solver.add(*(self._terms.range(atom) for atom in sorted(new)))
        return new

    def _afresh(self, obligation: Obligation, terms: Terms) -> Opinion:
        """The opinion of a solver that is told ever more: what the atoms in a claim stand for, the premises about them, and so on."""
        solver = _solver()
        solver.add(z3.Not(terms.claimed(obligation.formula)))
        premises = [(premise, atoms_in(premise.formula)) for premise in chain(obligation.premises)]
        waiting, seen = atoms_in(obligation.formula), set[int]()
        while True:
            seen |= waiting
            solver.add(*map(terms.meaning, sorted(waiting)))
            solver.add(*(terms.range(atom) for atom in sorted(waiting) if atom < obligation.claimed_atoms))
            near = [(premise, atoms) for premise, atoms in premises if not atoms.isdisjoint(waiting)]
            premises = [(premise, atoms) for premise, atoms in premises if atoms.isdisjoint(waiting)]
            solver.add(*(terms.said(premise.formula) for premise, _ in near))
            found = solver.check()
            waiting = set[int]().union(*(atoms for _, atoms in near), *map(terms.operands, waiting)) - seen
            if found == z3.unsat:
                return Opinion("proved")
            if not waiting:
                break
        if found != z3.sat:
            return Opinion("unknown")
        model = solver.model()
        atoms = [terms.atom(atom) for atom in sorted(atoms_in(obligation.formula))]
        return Opinion("refuted", tuple((str(atom), _integer(model.eval(atom, model_completion=True))) for atom in atoms))


def _integer(value: z3.ExprRef) -> int:
    return value.as_signed_long() if isinstance(value, z3.BitVecNumRef) else value.as_long()


def _solver() -> z3.Solver:
    solver = z3.Solver()
    solver.set("rlimit", MAX_Z3_STEPS)
    return solver
