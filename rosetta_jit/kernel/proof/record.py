"""What a kernel owes, written down while it is proven: each obligation with what is known at its place, and who proves it.

The proof writes here where somebody wants to read it; nothing here proves anything. What a path takes as known is of two kinds. *Given* is
what the kernel's text says: checks passed, branches taken, and, in a loop, what each round keeps. *Derived* is what the proof infers: of
arithmetic that is not linear, and where paths meet. What is derived is an obligation, too, so that a second opinion can judge it.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator

from rosetta_jit.kernel.ir import Site
from rosetta_jit.kernel.nodes import Expect, HostCall, Require, Stmt
from rosetta_jit.kernel.proof import claims
from rosetta_jit.kernel.proof.claims import Claim
from rosetta_jit.kernel.proof.formula import All, Formula, equal
from rosetta_jit.kernel.proof.linear import Linear, minus, shifted, times
from rosetta_jit.kernel.proof.prove import Facts, Procedure
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Premise:
    """Something taken as known, by a statement, and what was taken as known before it."""

    formula: Formula
    stmt: Stmt | None
    before: Premise | None


@dataclass(frozen=True, slots=True)
class Obligation:
    """One thing that a kernel owes.

    ``part`` is a body or a routine, ``path`` a field of the message, if a check names it. The bounds of atoms from ``claimed_atoms`` on
    are what is claimed, and no premise.
    """

    part: str
    stmt: Stmt | None
    path: str
    claim: Claim
    formula: Formula
    premises: Premise | None
    procedure: Procedure | None
    facts: RecordedFacts
    claimed_atoms: int


class RecordedFacts(Facts):
    """Facts that remember what was taken as known as it was said, and what each atom stands for."""

    def __init__(self, record: Record) -> None:
        super().__init__()
        self._record = record
        self.premises: Premise | None = None
        self.meanings: dict[int, tuple[object, ...]] = {}
        self.choices: dict[int, tuple[tuple[Formula, Linear], ...]] = {}
        self._meeting: list[Formula] | None = None

    def fresh(self, low: int, high: int) -> Linear:
        """As `Facts.fresh`; where paths meet, the bounds of an atom are claims."""
        atom = super().fresh(low, high)
        if self._meeting is not None:
            self._meeting.append(_within(atom, low, high))
        return atom

    def named(self, key: Hashable, low: int, high: int) -> Linear:
        """As `Facts.named`; the bounds must follow from what the atom stands for."""
        is_new = not self.has(key)
        atom = super().named(key, low, high)
        if is_new:
            number = atom.terms[0][0]
            self.meanings[number] = key if isinstance(key, tuple) else (key,)
            self._record.write(None, _within(atom, low, high), claims.OPERATION, number, "operations")
        return atom

    def chosen(self, cases: tuple[tuple[Formula, Linear], ...]) -> Linear:
        """As `Facts.chosen`."""
        atom = super().chosen(cases)
        self.meanings[atom.terms[0][0]] = self.choices[atom.terms[0][0]] = cases
        for bound in (
            shifted(atom, -min(self.lower(value) for _, value in cases)),
            shifted(times(atom, -1), max(self.upper(value) for _, value in cases)),
        ):
            self.derive(bound)
        return atom

    def abbreviated(self, value: Linear, low: int, high: int) -> Linear:
        """As `Facts.abbreviated`; the bounds must follow from what is known of the sum."""
        self._record.write(self.premises, _within(value, low, high), claims.BOUNDS, len(self.lows))
        atom = super().abbreviated(value, low, high)
        self._say(equal(atom, value))
        return atom

    def assume(self, formula: Formula) -> None:
        """As `Facts.assume`."""
        self._say(formula)
        super().assume(formula)

    def derive(self, formula: Formula) -> None:
        """As `Facts.derive`, and an obligation."""
        if formula is None:
            return
        if self._meeting is None:
            self._record.write(self.premises, formula, claims.OPERATION, len(self.lows), "operations")
        self._say(formula)
        super().derive(formula)

    def _say(self, formula: Formula) -> None:
        if formula is None:
            return
        if self._meeting is not None:
            self._meeting.append(formula)
        else:
            self._trail.append(("said", 0, None))
            self.premises = Premise(formula, self._record.stmt, self.premises)

    def rollback(self, mark: int) -> dict[tuple[tuple[int, int], ...], int]:
        """As `Facts.rollback`."""
        for kind, _, _ in self._trail[mark:]:
            if kind == "said" and self.premises is not None:
                self.premises = self.premises.before
        return super().rollback(mark)

    def meet(self, walk: Callable[[], None]) -> list[Formula]:
        """Whatever is taken as known in a walk: claims about all paths that meet."""
        claimed = self._meeting = []
        walk()
        self._meeting = None
        for formula in claimed:
            self._say(formula)
        return claimed


class Record:
    """The obligations of one kernel, in the order in which the proof meets them.

    Attributes
    ----------
    obligations : list of Obligation
    stmt : Stmt or None
        The statement where the proof is.
    """

    def __init__(self) -> None:
        self.obligations: list[Obligation] = []
        self._part = ""
        self._sites: tuple[Site, ...] = ()
        self.stmt: Stmt | None = None
        self._facts: RecordedFacts

    def begin(self, part: str, sites: tuple[Site, ...]) -> None:
        """What follows belongs to a body or a routine."""
        self._part, self._sites, self.stmt = part, sites, None

    def facts(self) -> RecordedFacts:
        """The facts of a part, at its beginning."""
        self._facts, self.stmt = RecordedFacts(self), None
        return self._facts

    def premises(self) -> Premise | None:
        """What is taken as known where the proof is."""
        return self._facts.premises

    def owe(self, formula: Formula, claim: Claim) -> None:
        """Write an obligation down."""
        self.write(self._facts.premises, formula, claim, len(self._facts.lows))

    def owe_all(self, formulas: Iterable[Formula], claim: Claim) -> None:
        """Write several down."""
        for formula in formulas:
            self.owe(formula, claim)

    def write(
        self, premises: Premise | None, formula: Formula, claim: Claim, claimed_atoms: int, procedure: Procedure | None = None
    ) -> None:
        """Write an obligation down, with who proves it."""
        facts, path = self._facts, self._path(premises, formula, claim)
        procedure = procedure or facts.procedure(formula)
        self.obligations.append(Obligation(self._part, self.stmt, path, claim, formula, premises, procedure, facts, claimed_atoms))

    def mark(self) -> int:
        """A point to go back to."""
        return len(self.obligations)

    def retract(self, mark: int) -> None:
        """Cross out what was written since a mark."""
        del self.obligations[mark:]

    def claimed(self, walk: Callable[[], None]) -> list[Formula]:
        """Whatever is taken as known in a walk, where paths meet."""
        return self._facts.meet(walk)

    # --- fields ------------------------------------------------------------------------------------------------------

    def _path(self, premises: Premise | None, formula: Formula, claim: Claim) -> str:
        """The field that the statement's own check names, or the check that covers what is accessed, or the last one."""
        if isinstance(self.stmt, Require | Expect | HostCall):
            return self._sites[self.stmt.failure.site].path
        checks = [premise for premise in chain(premises) if isinstance(premise.stmt, Require | Expect)]
        for premise in checks:
            found = self._covered(premise, formula) if claim is claims.BEFORE_END else None
            if found is not None:
                return found
        return self._site(checks[0]).path if checks else ""

    def _covered(self, premise: Premise, formula: Formula) -> str | None:
        """The field whose bytes a Require checked, if an access ends in it. Both formulas tell how far the message goes on behind."""
        match premise.formula, formula:
            case All((Linear(), Linear(size, ()), Linear() as rest)), Linear() if isinstance(premise.stmt, Require):
                last = minus(rest, formula)
                if last.terms or not 0 <= size + last.constant - 1 < size:
                    return None
                site, end = self._site(premise), size + last.constant - 1
                return next((part.path for part in reversed(site.parts) if part.offset <= end), site.path)
            case _:
                return None

    def _site(self, premise: Premise) -> Site:
        assert isinstance(premise.stmt, Require | Expect)
        return self._sites[premise.stmt.failure.site]


def chain(premise: Premise | None) -> Iterator[Premise]:
    """All that is taken as known, the last first."""
    while premise is not None:
        yield premise
        premise = premise.before


def _within(value: Linear, low: int, high: int) -> Formula:
    return All((shifted(value, -low), shifted(times(value, -1), high)))
