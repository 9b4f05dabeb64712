"""The fields that rules name: those of the wire that relations read, and those that rules set."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.inverse import fields_in
from rosetta_jit.model.mapping import Assign, Default, For, Relation, SetLength, When
from rosetta_jit.model.walk import names_of, path_of

if TYPE_CHECKING:
    from rosetta_jit.model.mapping import Rule
    from rosetta_jit.model.walk import Field


def is_among(place: Field, fields: frozenset[tuple[str, ...]]) -> bool:
    """Whether a field, something in it or around it is one of these."""
    names = names_of(path_of(place))
    return any(all(a == b for a, b in zip(names, other, strict=False)) for other in fields)


def fields_in_rules(rules: tuple[Rule, ...]) -> list[Field]:
    """The fields of the wire that relations read."""
    found: list[Field] = []
    for rule in rules:
        match rule:
            case Relation(value=value):
                found += fields_in(value)
            case For(body=body):
                found += fields_in_rules(body)
            case When(condition, then, otherwise):
                found += [*fields_in(condition), *fields_in_rules((*then, *otherwise))]
            case _:
                pass
    return found


def set_by(rules: tuple[Rule, ...], *, lengths: bool) -> list[tuple[str, ...]]:
    """The fields that rules set, without indices."""
    found: list[tuple[str, ...]] = []
    for rule in rules:
        match rule:
            case Assign(place) | Default(place):
                found.append(names_of(place))
            case SetLength(place) if lengths:
                found.append(names_of(place))
            case For(body=body):
                found += set_by(body, lengths=lengths)
            case When(then=then, otherwise=otherwise):
                found += set_by((*then, *otherwise), lengths=lengths)
            case _:
                pass
    return found
