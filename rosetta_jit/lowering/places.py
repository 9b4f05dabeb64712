"""The places that rules set."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.lowering.typed import Assign, Default, FieldStep, For, Ignore, Reject, SetLength, When

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.lowering.typed import Place, Rule


def field_names(place: Place) -> tuple[str, ...]:
    """The fields on the way to a place, without indices."""
    return tuple(step.field.name for step in place.steps if isinstance(step, FieldStep))


def places_in(rules: tuple[Rule, ...]) -> list[Place]:
    """All places that rules set, those within blocks included."""
    return [place for rule in rules for place in _places(rule)]


def rules_within(rules: tuple[Rule, ...]) -> Iterator[Rule]:
    """The rules in all blocks, without the blocks."""
    for rule in rules:
        match rule:
            case For(body=body):
                yield from rules_within(body)
            case When(_, then, otherwise):
                yield from rules_within((*then, *otherwise))
            case _:
                yield rule


def _places(rule: Rule) -> list[Place]:
    match rule:
        case Assign(place) | SetLength(place) | Default(place):
            return [place]
        case For():
            return places_in(rule.body)
        case When():
            return places_in((*rule.then, *rule.otherwise))
        case Reject() | Ignore():
            return []
        case _:
            assert_never(rule)
