"""Cases of tables and choices that are never chosen, since an earlier one asks the same."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.catalogue import check as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.model.expr import Choice, Expr
from rosetta_jit.model.mapping import Mapping
from rosetta_jit.model.walk import every_rule, expressions_of, parts


def unreachable(mapping: Mapping) -> list[Diagnostic]:
    """Warnings about the blocks for one direction: in a relation a second case may say which of several values is packed."""
    every = [*every_rule(mapping.unpack_rules or ()), *every_rule(mapping.pack_rules or ())]
    choices = [part for rule in every for expr in expressions_of(rule) for part in parts(expr) if isinstance(part, Choice)]
    return [words.case_twice(condition.span) for choice in choices for condition in _again(choice)]


def _again(choice: Choice) -> Iterator[Expr]:
    seen: set[Expr] = set()
    for condition, _ in choice.cases:
        if condition in seen:
            yield condition
        seen.add(condition)
