"""How the proof demands what a kernel owes, and tells a record of it where one is kept."""

from __future__ import annotations

from rosetta_jit.kernel.proof.claims import Claim
from rosetta_jit.kernel.proof.formula import Formula
from rosetta_jit.kernel.proof.linear import Linear
from rosetta_jit.kernel.proof.scope import Scope


class UnprovenError(AssertionError):
    """An obligation that does not follow from what is known."""


def oblige(scope: Scope, formula: Formula, claim: Claim) -> None:
    """Demand a proof."""
    if scope.record is not None:
        scope.record.owe(formula, claim)
    facts = scope.facts
    if isinstance(formula, Linear) and facts.is_shown(formula):
        return  # as most are
    if not facts.proves_thoroughly(formula):
        raise UnprovenError(claim.otherwise)


def certify(scope: Scope, holds: bool, claim: Claim) -> None:
    """Demand what shows in the kernel's constants; the kernel owes it on paths that nothing takes, too."""
    if scope.record is not None:
        scope.record.owe(holds, claim)
    demand(holds, claim.otherwise)


def demand(holds: bool, otherwise: str) -> None:
    """Demand a rule of the text, such as the type of an operand."""
    if not holds:
        raise UnprovenError(otherwise)
