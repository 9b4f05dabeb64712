"""Shares: the part of the holder that messages of one of several wires fill.

It is cleared before a message fills it, and nothing else is touched. So all rules of a field run at messages of the same wires, but for
arrays of numbers or texts whose elements several wires set: those are *joined*.
"""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.catalogue import wires as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.check.across_wires import Wires
from rosetta_jit.language.check.wire_needs import Names, Needs, cutter, owners_of, with_needs
from rosetta_jit.language.check.wires import rules_of
from rosetta_jit.language.places import places_in, shown_names
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Assign, FieldStep, Place, Rule, SetLength
from rosetta_jit.model.expr import Side
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, String, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Share:
    """What a message of one wire fills of the holder.

    Attributes
    ----------
    number
        Of the wire, from 0 on.
    cleared
        Fields that are cleared first, by the way to them; none lies within an array or a union.
    alone
        Messages around them that can be absent, and hold nothing else: they are absent again, too.
    joined
        Arrays that have elements of other wires, too.
    """

    number: int
    cleared: frozenset[Names]
    alone: frozenset[Names]
    joined: frozenset[Names]


def share_of(rules: tuple[Rule, ...], wire: str, wires: Sequence[str], holder: Message) -> Share:
    """What a message of one of the wires fills, of all rules to unpack."""
    cut = cutter(holder)
    owners = owners_of(rules, cut)
    mine = {cut(place) for place in places_in(rules_of(rules, wire, "holder", holder))}
    joined = frozenset(names for names in mine if len(owners.get(names, ())) > 1)
    elsewhere = {names for names, groups in owners.items() if len(groups) != 1 or any(wire not in each for each in groups)}
    around = {names[:count] for names in mine - joined for count in range(1, len(names))}
    alone = (names for names in around if not any(other[: len(names)] == names for other in elsewhere))
    return Share(wires.index(wire), frozenset(mine) - joined, frozenset(alone), joined)


def wrong_wires(rules: tuple[Rule, ...], target: Side, holder: Message) -> list[Diagnostic]:
    """Reports of rules that need several wires at once, and, of rules to unpack, of fields that several wires set."""
    every = with_needs(rules, target)
    problems = [words.apart(rule.span, sorted(needs.wires)) for rule, needs in every if needs.wires and not needs.runs_at]
    return problems or (_overlaps(rules, every, holder) if target == "holder" else [])


def _overlaps(rules: tuple[Rule, ...], every: list[tuple[Rule, Needs]], holder: Message) -> list[Diagnostic]:
    problems: list[Diagnostic] = []
    cut = cutter(holder)
    shared = [names for names, groups in owners_of(rules, cut).items() if len(groups) > 1]
    for names in shared:
        mine = [(rule, needs.runs_at, place) for rule, needs in every for place in places_in((rule,)) if cut(place) == names]
        if _can_be_joined(names, mine, holder):
            continue
        first: tuple[Wires, Span | None] | None = None
        for rule, wires in ((rule, wires) for rule, wires, _ in mine if wires):
            if first is None:
                first = wires, rule.span
            elif wires != first[0]:
                both = min(first[0] - wires or first[0]), min(wires - first[0] or wires)
                path, is_array = shown_names(names, holder), isinstance(_type_at(names, mine, holder), Array)
                problems.append(words.set_by_several(rule.span, path, both, first[1], is_array=is_array))
    return problems


def _type_at(names: Names, mine: list[tuple[Rule, Wires, Place]], holder: Message) -> Type:
    """The type of a field that some rules set."""
    last = next(step.field for _, _, place in mine for step in place.steps[len(names) - 1 : len(names)] if isinstance(step, FieldStep))
    return holder.value_type(last.type)


def _can_be_joined(names: Names, mine: list[tuple[Rule, Wires, Place]], holder: Message) -> bool:
    """Whether a field is an array of numbers or texts, whose length no wire tells, and of which wires set single elements."""
    type_ = _type_at(names, mine, holder)
    if not isinstance(type_, Array) or not isinstance(holder.value_type(type_.element), Bool | Int | Float | Enum | String | Bytes):
        return False
    elements = [(rule, place) for rule, wires, place in mine if wires]
    lengths = [rule for rule, wires, _ in mine if not wires and isinstance(rule, SetLength)]
    is_told = isinstance(type_.length, int) or bool(lengths)
    whole = [rule for rule, wires, place in mine if not wires and isinstance(rule, Assign) and len(place.steps) == len(names)]
    return is_told and not whole and all(isinstance(rule, Assign) and len(place.steps) == len(names) + 1 for rule, place in elements)
