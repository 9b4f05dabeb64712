"""The ways through a direction: which of its conditions hold, and the rules that then run."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.limits import MAX_WAYS
from rosetta_jit.language.typed import For, Reject, When
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.language.algebra.equality import Ranges
    from rosetta_jit.language.typed import Expr, Rule

Known = tuple[tuple["Expr", bool, "Ranges"], ...]
"""Conditions, whether they hold, and the loops in all of whose rounds."""


class UnfollowedError(Exception):
    """More ways than `MAX_WAYS`; never leaves the laws."""


@dataclass(frozen=True, slots=True)
class Way:
    """One way through a direction: what is known on it, and the rules that run."""

    known: Known
    rules: tuple[Rule, ...]


def ways(rules: tuple[Rule, ...]) -> list[Way]:
    """Every way through a direction that is not rejected.

    Raises
    ------
    UnfollowedError
    """
    found = [Way((), ())]
    for rule in rules:
        parts = _ways_of(rule)
        if len(found) * len(parts) > MAX_WAYS:
            raise UnfollowedError
        found = [Way((*before.known, *part.known), (*before.rules, *part.rules)) for before in found for part in parts]
    return found


def _ways_of(rule: Rule) -> list[Way]:
    match rule:
        case When(condition, then, otherwise):
            blocks = [(condition, True, then), (condition, False, otherwise)]
            return [Way(((known, holds, ()), *way.known), way.rules) for known, holds, block in blocks for way in ways(block)]
        case For(_, start, stop, body):
            found = ways(body)
            around = [tuple((known, holds, ((start, stop), *ranges)) for known, holds, ranges in way.known) for way in found]
            return [Way(known, (replace(rule, body=way.rules),)) for known, way in zip(around, found, strict=True)]
        case Reject():
            return []
        case _:
            return [Way((), (rule,))]
