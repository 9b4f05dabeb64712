"""The execution paths of a direction: which of its conditions hold, and the rules that then run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language.limits import MAX_WAYS
from rosetta_jit.language.typed import Expr, For, Reject, Rule, When
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.language.algebra.equality import Ranges

Known = tuple[tuple["Expr", bool, "Ranges"], ...]
"""Conditions, whether they hold, and the loops in all of whose rounds."""


class UnfollowedError(Exception):
    """More paths than `MAX_WAYS`; never leaves the laws."""


@dataclass(frozen=True, slots=True)
class ExecutionPath:
    """One execution path of a direction: what is known on it, and the rules that run."""

    known: Known
    rules: tuple[Rule, ...]


def execution_paths(rules: tuple[Rule, ...]) -> list[ExecutionPath]:
    """Every execution path of a direction that is not rejected; raises UnfollowedError."""
    found = [ExecutionPath((), ())]
    for rule in rules:
        parts = _paths_of(rule)
        if len(found) * len(parts) > MAX_WAYS:
            raise UnfollowedError
        found = [ExecutionPath((*before.known, *part.known), (*before.rules, *part.rules)) for before in found for part in parts]
    return found


def _paths_of(rule: Rule) -> list[ExecutionPath]:
    match rule:
        case When(condition, then, otherwise):
            blocks = [(condition, True, then), (condition, False, otherwise)]
            return [
                ExecutionPath(((known, holds, ()), *path.known), path.rules)
                for known, holds, block in blocks
                for path in execution_paths(block)
            ]
        case For(_, start, stop, body):
            found = execution_paths(body)
            around = [tuple((known, holds, ((start, stop), *ranges)) for known, holds, ranges in path.known) for path in found]
            return [ExecutionPath(known, (replace(rule, body=path.rules),)) for known, path in zip(around, found, strict=True)]
        case Reject():
            return []
        case _:
            return [ExecutionPath((), (rule,))]
