"""Cases of tables and choices that are never chosen, since an earlier one asks the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import check as words
from rosetta_jit.model.expr import Choice
from rosetta_jit.model.mapping import For, When
from rosetta_jit.model.walk import expressions_of, parts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.mapping import Mapping, Rule


def unreachable(mapping: Mapping) -> list[Diagnostic]:
    """Warnings about the blocks for one direction: in a relation a second case may say which of several values is packed."""
    every = [*_every(mapping.unpack_rules or ()), *_every(mapping.pack_rules or ())]
    choices = [part for rule in every for expr in expressions_of(rule) for part in parts(expr) if isinstance(part, Choice)]
    return [words.case_twice(condition.span) for choice in choices for condition in _again(choice)]


def _again(choice: Choice) -> Iterator[Expr]:
    seen: set[Expr] = set()
    for condition, _ in choice.cases:
        if condition in seen:
            yield condition
        seen.add(condition)


def _every(rules: tuple[Rule, ...]) -> Iterator[Rule]:
    for rule in rules:
        yield rule
        match rule:
            case For(body=body):
                yield from _every(body)
            case When(then=then, otherwise=otherwise):
                yield from _every((*then, *otherwise))
            case _:
                pass
