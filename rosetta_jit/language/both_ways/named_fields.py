"""The fields that rules name: those of the wire that relations read, and those that rules set."""

from __future__ import annotations

from rosetta_jit.language.both_ways.inverse import fields_in
from rosetta_jit.model.mapping import Assign, Default, Relation, Rule, SetLength, When
from rosetta_jit.model.walk import Field, every_rule, names_of, path_of


def is_among(place: Field, fields: frozenset[tuple[str, ...]]) -> bool:
    """Whether a field, something in it or around it is one of these."""
    names = names_of(path_of(place))
    return any(all(a == b for a, b in zip(names, other, strict=False)) for other in fields)


def fields_in_rules(rules: tuple[Rule, ...]) -> list[Field]:
    """The fields of the wire that relations read."""
    found: list[Field] = []
    for rule in every_rule(rules):
        match rule:
            case Relation(value=value) | When(condition=value):
                found += fields_in(value)
            case _:
                pass
    return found


def set_by(rules: tuple[Rule, ...], *, lengths: bool) -> list[tuple[str, ...]]:
    """The fields that rules set, without indices."""
    found = [rule for rule in every_rule(rules) if isinstance(rule, Assign | Default | SetLength)]
    return [names_of(rule.place) for rule in found if lengths or not isinstance(rule, SetLength)]
