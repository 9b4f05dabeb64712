"""The order of rules: each discriminator is set before anything in a case of its union, which is checked against it.

A *spot* is one union: the name of its discriminator, and the indices on the way there. No discriminator is set twice (`completeness`), so
that rules which set the discriminator of each spot themselves can stand anywhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from heapq import heappop, heappush
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import check as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.check.discriminators import Discriminator, Names, discriminator_of
from rosetta_jit.language.limits import MAX_LABELS
from rosetta_jit.language.places import field_names, rules_within, shown_fields
from rosetta_jit.language.typed import Assign, Assignment, Const, Default, Expr, For, IndexStep, Local, Place, Rule, SetLength, When
from rosetta_jit.language.walk import indices
from rosetta_jit.model.types import Array, Bool, Map
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    Spot = tuple[Names, tuple[Expr, ...]]
    Node = int | tuple[Names, tuple[Expr, ...] | str | int]

COMPUTED, ANY = "computed", "any"
"""Instead of the indices of a spot: all those that are not constant, and all."""


def discriminators_first(rules: tuple[Rule, ...], unions: Mapping[Names, Discriminator], problems: list[Diagnostic]) -> tuple[Rule, ...]:
    """The rules in an order in which each discriminator is set before a case of its union.

    A problem where there is no such order, or where labels are too many.
    """
    by_rule = {names: each for names, each in unions.items() if each.by_rule}
    if not by_rule:
        return rules
    computed = (rule for rule in rules_within(rules) if isinstance(rule, Assign) and not isinstance(rule.value, Const))
    labels = sum(sum(map(len, by_rule[names].union.labels)) for rule in computed if (names := field_names(rule.place)) in by_rule)
    if labels > MAX_LABELS:
        problems.append(words.many_labels(rules[0].span, MAX_LABELS))
    return _ordered(rules, by_rule, problems)


def _ordered(rules: tuple[Rule, ...], by_rule: Mapping[Names, Discriminator], problems: list[Diagnostic]) -> tuple[Rule, ...]:
    rules = tuple(_inside(rule, by_rule, problems) for rule in rules)
    setting = [_set_by(rule, by_rule) for rule in rules]
    if not any(setting):
        return rules
    try:
        return tuple(rules[number] for number in _sorted(_before(rules, setting, by_rule)))
    except CycleError as error:
        late = next(number for number in error.args[1] if isinstance(number, int) and setting[number])
        problems.append(_late(setting[late][0]))
        return rules


def _inside(rule: Rule, by_rule: Mapping[Names, Discriminator], problems: list[Diagnostic]) -> Rule:
    match rule:
        case For(variable, body=body):
            found = _ordered(body, by_rule, problems)
            problems += [_late(place) for place in _set_in_other_rounds(found, variable, by_rule)]
            return replace(rule, body=found)
        case When(_, then, otherwise):
            return replace(rule, then=_ordered(then, by_rule, problems), otherwise=_ordered(otherwise, by_rule, problems))
        case Default(place, span) if field_names(place) in by_rule:
            return Assign(place, _zero(place, span), span)
        case _:
            return rule


def _zero(place: Place, span: Span | None) -> Const:
    return Const(False if isinstance(place.type, Bool) else 0, place.type, span)


def _late(place: Place) -> Diagnostic:
    return words.late_discriminator(place.span, shown_fields(place.steps))


def _before(rules: tuple[Rule, ...], setting: list[list[Place]], by_rule: Mapping[Names, Discriminator]) -> TopologicalSorter[Node]:
    """What comes before what. Between rules, by number, stand nodes for all that set one thing: the graph grows as the rules do."""
    found: TopologicalSorter[Node] = TopologicalSorter()
    setters: dict[Node, set[int]] = {}
    for number, places in enumerate(setting):
        for place in places:
            names = field_names(place)
            spot = _spot(place, len(place.steps), names)
            for node in (spot if _is_constant(spot) else (names, COMPUTED), (names, ANY)):
                setters.setdefault(node, set()).add(number)
    for node, numbers in setters.items():
        found.add(node, *numbers)
    lengths: dict[Names, int] = {}
    for number, rule in enumerate(rules):
        needed = {node for spot in _unset((rule,), by_rule) for node in _setters_of(spot)}
        arrays = {array for each in _settings(rule) for array in _arrays(each.place) if array in lengths}
        alone = (node for node in needed if setters.get(node, set()) - {number})
        found.add(number, *alone, *((array, lengths[array]) for array in arrays))
        for array in {field_names(each.place) for each in _settings(rule) if isinstance(each.place.type, Array | Map)}:
            before = lengths.get(array, -1)
            lengths[array] = number
            found.add((array, number), number, *([(array, before)] if before >= 0 else []))
    return found


def _setters_of(spot: Spot) -> tuple[Node, ...]:
    """The nodes of those that may set the discriminator of a union."""
    return (spot, (spot[0], COMPUTED)) if _is_constant(spot) else ((spot[0], ANY),)


def _is_constant(spot: Spot) -> bool:
    return all(isinstance(index, Const) for index in spot[1])


def _sorted(before: TopologicalSorter[Node]) -> Iterator[int]:
    """The rules in the order that they have, where that is one; raises CycleError."""
    before.prepare()
    ready: list[int] = []
    while before.is_active():
        while nodes := before.get_ready():
            for node in nodes:
                if isinstance(node, int):
                    heappush(ready, node)
                else:
                    before.done(node)
        if ready:
            number = heappop(ready)
            yield number
            before.done(number)


def _set_in_other_rounds(body: tuple[Rule, ...], variable: str, by_rule: Mapping[Names, Discriminator]) -> Iterator[Place]:
    """Discriminators that one round of a loop may set after another round has filled a case.

    Rounds are apart where all that they set is in the element of the loop's own number.
    """
    unset = _unset(body, by_rule)
    for names in {names for names, _ in unset}:
        setting = [place for rule in body for place in _set_by(rule, by_rule) if field_names(place) == names]
        spots = [*(spot for spot in unset if spot[0] == names), *(_spot(place, len(place.steps), names) for place in setting)]
        apart = any(all(index == Local(variable) for index in indices) for indices in zip(*(indices for _, indices in spots), strict=True))
        if setting and not apart:
            yield setting[0]


# --- spots ---------------------------------------------------------------------------------------------------------------


def _settings(rule: Rule) -> list[Assignment | SetLength[Place, Expr] | Default[Place]]:
    return [each for each in rules_within((rule,)) if isinstance(each, Assign | SetLength | Default)]


def _set_by(rule: Rule, by_rule: Mapping[Names, Discriminator]) -> list[Place]:
    """The discriminators that a rule sets."""
    return [each.place for each in _settings(rule) if field_names(each.place) in by_rule]


def _unset(rules: tuple[Rule, ...], by_rule: Mapping[Names, Discriminator]) -> list[Spot]:
    """The unions that rules fill without setting their discriminators on each way there."""
    found: list[Spot] = []
    for rule in rules:
        match rule:
            case For(body=body):
                found += _unset(body, by_rule)
            case When(_, then, otherwise):
                found += [*_unset(then, by_rule), *_unset(otherwise, by_rule)]
            case Assign(place) | SetLength(place) | Default(place):
                found += [spot for spot in _filled(place) if spot[0] in by_rule]
            case _:
                pass
    known = _always_set(rules, by_rule) if found else set[object]()
    return [spot for spot in found if spot not in known]


def _always_set(rules: tuple[Rule, ...], by_rule: Mapping[Names, Discriminator]) -> set[Spot]:
    """The unions whose discriminators a block sets, whatever its conditions are."""
    found: set[Spot] = set()
    for rule in rules:
        match rule:
            case For(body=body):
                found |= _always_set(body, by_rule)
            case When(_, then, otherwise):
                found |= _always_set(then, by_rule) & _always_set(otherwise, by_rule)
            case Assign(place) | Default(place) if (names := field_names(place)) in by_rule:
                found.add(_spot(place, len(place.steps), names))
            case _:
                pass
    return found


def _filled(place: Place) -> list[Spot]:
    """The unions that a place is in a case of, or is."""
    steps = range(1, len(place.steps) + 1)
    return [_spot(place, number, names) for number in steps if (names := discriminator_of(place, number)) is not None]


def _spot(place: Place, steps: int, names: Names) -> Spot:
    return names, indices(replace(place, steps=place.steps[:steps]))


def _arrays(place: Place) -> list[Names]:
    """The arrays that a place is in."""
    return [
        field_names(replace(place, steps=place.steps[:number])) for number, step in enumerate(place.steps) if isinstance(step, IndexStep)
    ]
