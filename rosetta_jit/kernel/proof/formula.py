r"""What is said of a kernel's integers: inequalities, joined by and and or.

    Formula = True | False | None | Linear | All(Formula*) | Any(Formula*)

A `Linear` as a formula says that it is >= 0; None says nothing.
"""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.kernel.limits import MAX_FORMULA
from rosetta_jit.kernel.proof.linear import Linear, minus, shifted, times
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class All:
    """Every part holds."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Any:
    """One part at least holds."""

    parts: tuple[Formula, ...]


Formula = bool | None | Linear | All | Any


def said(formula: Formula) -> Formula:
    """What a formula says without its parts of which nothing is known: those of two formulas look alike, and are not."""
    match formula:
        case All(parts):
            return All(tuple(part for each in parts if (part := said(each)) is not None))
        case Any(parts):
            found = tuple(map(said, parts))
            return None if None in found else Any(found)
        case _:
            return formula


def negated(formula: Formula) -> Formula:
    """The opposite; over integers ``not (l >= 0)`` is ``-l - 1 >= 0``."""
    match formula:
        case bool():
            return not formula
        case None:
            return None
        case Linear():
            return shifted(times(formula, -1), -1)
        case All(parts):
            return Any(tuple(map(negated, parts)))
        case Any(parts):
            return All(tuple(map(negated, parts)))
        case _:
            assert_never(formula)


def bounded(formula: Formula) -> Formula:
    """The formula, or None where it is so large that taking it apart again and again would cost too much."""
    return formula if _size(formula) <= MAX_FORMULA else None


def is_vague(formula: Formula) -> bool:
    """Whether a formula says less than what it stands for."""
    match formula:
        case None:
            return True
        case All(parts) | Any(parts):
            return any(map(is_vague, parts))
        case _:
            return False


def shares_atom(fact: Any, goal: Linear) -> bool:
    """Whether an alternative is directly about an atom of a goal."""
    atoms = {atom for atom, _ in goal.terms}
    return any(isinstance(part, Linear) and not atoms.isdisjoint(a for a, _ in part.terms) for part in fact.parts)


def _size(formula: Formula) -> int:
    match formula:
        case All(parts) | Any(parts):
            return sum(map(_size, parts))
        case _:
            return 1


def equal(left: Linear, right: Linear) -> Formula:
    """``left == right``."""
    difference = minus(left, right)
    return All((difference, times(difference, -1)))
