"""Rules for several places: `.roll, .pitch, .yaw = euler(.q)` as one rule a place.

The value is a group of as many numbers (`language.groups`), of which each place gets one; or a list, of which each gets an item. For both
directions a group stays whole, for it is turned round as a whole: a `Relation` with a list of places.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import groups as words
from rosetta_jit.language.groups import component, group_of
from rosetta_jit.model.expr import List
from rosetta_jit.model.mapping import Assign, Relation

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.mapping import Rule, Several


def one_by_one(rule: Several, problems: list[Diagnostic]) -> tuple[Rule, ...]:
    """The rules that a rule for several places stands for; none, and reported, where its value has not as many numbers."""
    group = group_of(rule.value)
    if group is not None:
        values: tuple[Expr, ...] = tuple(component(rule.value, number) for number in range(len(group.components)))
    elif isinstance(rule.value, List):
        values = rule.value.items
    else:
        problems.append(words.no_group(rule.value.span))
        return ()
    if len(values) != len(rule.places):
        names = () if group is None else tuple(each.names[0] for each in group.components)
        problems.append(words.other_count(rule.span, len(rule.places), len(values), names))
        return tuple(Assign(place, value, rule.span) for place, value in zip(rule.places, values, strict=False) if not rule.is_relation)
    if rule.is_relation and group is not None:
        return (Relation(List(rule.places, rule.span), rule.value, rule.span),)
    pairs = tuple(zip(rule.places, values, strict=True))
    if rule.is_relation:
        return tuple(Relation(place, value, rule.span) for place, value in pairs)
    return tuple(Assign(place, value, rule.span) for place, value in pairs)
