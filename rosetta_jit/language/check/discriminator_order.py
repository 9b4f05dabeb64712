"""The order of rules: each discriminator is set before anything in a case of its union, which is checked against it.

A *spot* is one union: the name of its discriminator, and the indices on the way there. No discriminator is set twice (`completeness`), so
that rules which set the discriminator of each spot themselves can stand anywhere.
"""

from __future__ import annotations

from dataclasses import replace
from graphlib import CycleError, TopologicalSorter
from heapq import heappop, heappush
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import check as words
from rosetta_jit.language.check.discriminators import discriminator_of
from rosetta_jit.language.places import field_names, rules_within, shown_fields
from rosetta_jit.language.typed import Assign, Const, Default, For, IndexStep, Local, SetLength, When
from rosetta_jit.model.types import Array, Bool, Map

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.language.check.discriminators import Names, Told
    from rosetta_jit.language.typed import Expr, Place, Rule
    from rosetta_jit.source import Span

    Spot = tuple[Names, tuple[Expr, ...]]
    Node = int | tuple[Names, tuple[Expr, ...] | str | int]

COMPUTED, ANY = "computed", "any"
"""Instead of the indices of a spot: all those that are not constant, and all."""

MAX_LABELS = 5_000
"""Labels that all values of discriminators together are compared with."""


def discriminators_first(rules: tuple[Rule, ...], unions: Mapping[Names, Told], problems: list[Diagnostic]) -> tuple[Rule, ...]:
    """The rules in an order in which each discriminator is set before a case of its union.

    A problem where there is no such order, or where labels are too many.
    """
    told = {names: each for names, each in unions.items() if each.by_rule}
    if not told:
        return rules
    computed = (rule for rule in rules_within(rules) if isinstance(rule, Assign) and not isinstance(rule.value, Const))
    labels = sum(sum(map(len, told[names].union.labels)) for rule in computed if (names := field_names(rule.place)) in told)
    if labels > MAX_LABELS:
        problems.append(words.many_labels(rules[0].span, MAX_LABELS))
    return _ordered(rules, told, problems)


def _ordered(rules: tuple[Rule, ...], told: Mapping[Names, Told], problems: list[Diagnostic]) -> tuple[Rule, ...]:
    rules = tuple(_inside(rule, told, problems) for rule in rules)
    telling = [_telling(rule, told) for rule in rules]
    if not any(telling):
        return rules
    try:
        return tuple(rules[number] for number in _sorted(_before(rules, telling, told)))
    except CycleError as error:
        late = next(number for number in error.args[1] if isinstance(number, int) and telling[number])
        problems.append(_late(telling[late][0]))
        return rules


def _inside(rule: Rule, told: Mapping[Names, Told], problems: list[Diagnostic]) -> Rule:
    match rule:
        case For(variable, body=body):
            found = _ordered(body, told, problems)
            problems += [_late(place) for place in _told_in_other_rounds(found, variable, told)]
            return replace(rule, body=found)
        case When(_, then, otherwise):
            return replace(rule, then=_ordered(then, told, problems), otherwise=_ordered(otherwise, told, problems))
        case Default(place, span) if field_names(place) in told:
            return Assign(place, _zero(place, span), span)
        case _:
            return rule


def _zero(place: Place, span: Span | None) -> Const:
    return Const(False if isinstance(place.type, Bool) else 0, place.type, span)


def _late(place: Place) -> Diagnostic:
    return words.late_discriminator(place.span, shown_fields(place.steps))


def _before(rules: tuple[Rule, ...], telling: list[list[Place]], told: Mapping[Names, Told]) -> TopologicalSorter[Node]:
    """What comes before what. Between rules, by number, stand nodes for all that set one thing: the graph grows as the rules do."""
    found: TopologicalSorter[Node] = TopologicalSorter()
    tellers: dict[Node, set[int]] = {}
    for number, places in enumerate(telling):
        for place in places:
            names = field_names(place)
            spot = _spot(place, len(place.steps), names)
            for node in (spot if _is_constant(spot) else (names, COMPUTED), (names, ANY)):
                tellers.setdefault(node, set()).add(number)
    for node, numbers in tellers.items():
        found.add(node, *numbers)
    lengths: dict[Names, int] = {}
    for number, rule in enumerate(rules):
        needed = {node for spot in _untold((rule,), told) for node in _tellers_of(spot)}
        arrays = {array for each in _settings(rule) for array in _arrays(each.place) if array in lengths}
        alone = (node for node in needed if tellers.get(node, set()) - {number})
        found.add(number, *alone, *((array, lengths[array]) for array in arrays))
        for array in {field_names(each.place) for each in _settings(rule) if isinstance(each.place.type, Array | Map)}:
            before = lengths.get(array, -1)
            lengths[array] = number
            found.add((array, number), number, *([(array, before)] if before >= 0 else []))
    return found


def _tellers_of(spot: Spot) -> tuple[Node, ...]:
    """The nodes of those that may set the discriminator of a union."""
    return (spot, (spot[0], COMPUTED)) if _is_constant(spot) else ((spot[0], ANY),)


def _is_constant(spot: Spot) -> bool:
    return all(isinstance(index, Const) for index in spot[1])


def _sorted(before: TopologicalSorter[Node]) -> Iterator[int]:
    """The rules in the order that they have, where that is one.

    Raises
    ------
    CycleError
    """
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


def _told_in_other_rounds(body: tuple[Rule, ...], variable: Local, told: Mapping[Names, Told]) -> Iterator[Place]:
    """Discriminators that one round of a loop may set after another round has filled a case.

    Rounds are apart where all that they set is in the element of the loop's own number.
    """
    untold = _untold(body, told)
    for names in {names for names, _ in untold}:
        telling = [place for rule in body for place in _telling(rule, told) if field_names(place) == names]
        spots = [*(spot for spot in untold if spot[0] == names), *(_spot(place, len(place.steps), names) for place in telling)]
        apart = any(all(index == variable for index in indices) for indices in zip(*(indices for _, indices in spots), strict=True))
        if telling and not apart:
            yield telling[0]


# --- spots ---------------------------------------------------------------------------------------------------------------


def _settings(rule: Rule) -> list[Assign | SetLength | Default]:
    return [each for each in rules_within((rule,)) if isinstance(each, Assign | SetLength | Default)]


def _telling(rule: Rule, told: Mapping[Names, Told]) -> list[Place]:
    """The discriminators that a rule sets."""
    return [each.place for each in _settings(rule) if field_names(each.place) in told]


def _untold(rules: tuple[Rule, ...], told: Mapping[Names, Told]) -> list[Spot]:
    """The unions that rules fill without setting their discriminators on each way there."""
    found: list[Spot] = []
    for rule in rules:
        match rule:
            case For(body=body):
                found += _untold(body, told)
            case When(_, then, otherwise):
                found += [*_untold(then, told), *_untold(otherwise, told)]
            case Assign(place) | SetLength(place) | Default(place):
                found += [spot for spot in _filled(place) if spot[0] in told]
            case _:
                pass
    known = _always_told(rules, told) if found else set[object]()
    return [spot for spot in found if spot not in known]


def _always_told(rules: tuple[Rule, ...], told: Mapping[Names, Told]) -> set[Spot]:
    """The unions whose discriminators a block sets, whatever its conditions are."""
    found: set[Spot] = set()
    for rule in rules:
        match rule:
            case For(body=body):
                found |= _always_told(body, told)
            case When(_, then, otherwise):
                found |= _always_told(then, told) & _always_told(otherwise, told)
            case Assign(place) | Default(place) if (names := field_names(place)) in told:
                found.add(_spot(place, len(place.steps), names))
            case _:
                pass
    return found


def _filled(place: Place) -> list[Spot]:
    """The unions that a place is in a case of, or is."""
    steps = range(1, len(place.steps) + 1)
    return [_spot(place, number, names) for number in steps if (names := discriminator_of(place, number)) is not None]


def _spot(place: Place, steps: int, names: Names) -> Spot:
    return names, tuple(step.index for step in place.steps[:steps] if isinstance(step, IndexStep))


def _arrays(place: Place) -> list[Names]:
    """The arrays that a place is in."""
    return [
        field_names(replace(place, steps=place.steps[:number])) for number, step in enumerate(place.steps) if isinstance(step, IndexStep)
    ]
