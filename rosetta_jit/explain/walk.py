"""Walks over typed rules, by the fields of their nodes: what a new node holds is found without a line for it here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from typing import cast

from rosetta_jit.language import typed
from rosetta_jit.language.typed import Place, Rule
from rosetta_jit.model.expr import Side
from rosetta_jit.model.walk import rules_in
from rosetta_jit.source import Span

NODES = (typed.__name__.rpartition(".")[0], typed.Assign.__module__)
"""Where the classes of nodes are; types, fields and spans are elsewhere."""


def nodes(root: object) -> Iterator[object]:
    """A node and all inside it, from the outside in; also those of a tuple."""
    pending = [root]
    while pending:
        node = pending.pop()
        if isinstance(node, tuple):
            pending.extend(reversed(cast("tuple[object, ...]", node)))
        elif is_dataclass(node) and type(node).__module__.startswith(NODES):
            yield node
            pending.extend(cast("object", getattr(node, each.name)) for each in reversed(fields(node)))


def places(root: object, side: Side) -> tuple[Place, ...]:
    """The places of one side within a node, each once."""
    found = [node for node in nodes(root) if isinstance(node, typed.Place) and node.side == side]
    return tuple(dict.fromkeys(found))


def names_of(place: Place) -> tuple[str, ...]:
    """The fields on the way to a place, without indices."""
    return tuple(step.field.name for step in place.steps if isinstance(step, typed.FieldStep))


Key = tuple[str, int, int]
"""Where something is written."""


def by_span(rules: Iterable[Rule]) -> dict[Key, list[Rule]]:
    """Rules, those in blocks included, by where they are written; one text may have become several."""
    found: dict[Key, list[Rule]] = {}
    pending = list(rules)
    while pending:
        rule = pending.pop(0)
        inside = [each for each in rules_in(rule) if span_of(each.span) != span_of(rule.span)]
        found.setdefault(span_of(rule.span), []).append(rule)
        pending += inside
    return found


def span_of(span: Span | None) -> Key:
    """The key of a place in a text."""
    return ("", -1, -1) if span is None else (span.source.name, span.start, span.end)
