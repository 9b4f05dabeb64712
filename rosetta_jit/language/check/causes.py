"""Reports in the order of causes: what follows from another mistake is left out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.model.mapping import For, Relation, When

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.mapping import Rule
    from rosetta_jit.source import Span

OF_NAMES = frozenset(("unknown-function", "unknown-name", "unknown-field"))
"""Mistakes that leave open what a rule means."""

OF_TYPES = frozenset(("type-clash", "lossy-conversion"))
"""Mistakes that each direction of a relation reports in its own words."""

OF_INVERSES = frozenset(("no-inverse",))


def relations_of(rules: tuple[Rule, ...]) -> list[Span]:
    """Where relations stand, those in blocks included."""
    return [span for span in _spans(rules) if span is not None]


def _spans(rules: tuple[Rule, ...]) -> Iterator[Span | None]:
    for rule in rules:
        match rule:
            case Relation(span=span):
                yield span
            case For(body=body):
                yield from _spans(body)
            case When(then=then, otherwise=otherwise):
                yield from _spans((*then, *otherwise))
            case _:
                pass


def unclear(problems: Iterable[Diagnostic], relations: Iterable[Span]) -> bool:
    """Whether a relation names what there is not: then it is open which field it packs."""
    named = [each.span for each in problems if each.code in OF_NAMES and each.span is not None]
    return any(_within(name, relation) for name in named for relation in relations)


def causes(problems: list[Diagnostic], relations: Iterable[Span]) -> list[Diagnostic]:
    """The reports without those that follow from others, in their order.

    A function that there is not has no inverse either, and what has the wrong type for one direction of a relation has it for the other.
    """
    named = [each.span for each in problems if each.code in OF_NAMES and each.span is not None]
    found = [each for each in problems if each.code not in OF_INVERSES or not any(each.span and _within(span, each.span) for span in named)]
    for relation in relations:
        here = [each for each in found if each.severity == "error" and each.span is not None and _within(each.span, relation)]
        follows = {id(each) for each in here[1:] if each.code in OF_TYPES}
        found = [each for each in found if id(each) not in follows]
    return found


def _within(span: Span, around: Span) -> bool:
    return span.source is around.source and around.start <= span.start and span.end <= around.end
