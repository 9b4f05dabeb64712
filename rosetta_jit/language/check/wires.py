"""Mappings of several wires: which rules a message of each wire runs.

Such a mapping is checked like any other: its wire is one message with a field for each wire (`message_of_wires`). A message of a wire
then runs the rules that read that wire, and those that read none; a rule that reads several runs where it can be computed
(`check.across_wires`). What a message fills is its share of the holder (`check.wire_shares`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import assert_never

from rosetta_jit.language import typed
from rosetta_jit.language.check.across_wires import (
    NOTHING_KEPT,
    Memory,
    Wires,
    asked_for,
    remembered,
    values_of_others,
    wire_of,
    wires_read,
)
from rosetta_jit.language.check.wire_needs import NO_WIRE, NOTHING_AROUND, Names, Needs, cutter, own_expressions, owners_of, with_needs
from rosetta_jit.language.places import places_in
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Assign, Default, Expr, For, Ignore, Place, Reject, Rule, SetLength, SetState, When
from rosetta_jit.language.untouched import asks_arrival
from rosetta_jit.language.walk import placed, rebuilt
from rosetta_jit.model import mapping as model
from rosetta_jit.model.expr import Side
from rosetta_jit.model.types import Field, Ref, Schema, Struct, same_name
from rosetta_jit.startup.dataclass import dataclass, replace


def message_of_wires(mapping: model.Mapping, schema: Schema) -> Schema:
    """The schema with the message that has a field for each wire; without it where a wire's type is unknown."""
    found = {each.name: next((name for name in schema.types if same_name(name, each.type)), None) for each in mapping.wires}
    fields = tuple(Field(name, Ref(type_)) for name, type_ in found.items() if type_ is not None)
    if not fields or len(fields) < len(found):
        return schema
    types = {**schema.types, mapping.wire_type: Struct(mapping.wire_type, fields)}
    return Schema(types, schema.sources, schema.constants, schema.left_out)


def kept_values(rules: tuple[Rule, ...]) -> list[tuple[str, Expr]]:
    """What rules to unpack that read several wires need of other messages than the one at hand: each with its wire."""
    found = [
        value for _, needs in with_needs(rules, "holder") if len(needs.wires) > 1 for value in values_of_others(needs.exprs, needs.wires)
    ]
    return [(wire, value) for value in dict.fromkeys(found) for wire in wires_read([value])]


def rules_of(rules: tuple[Rule, ...], wire: str, target: Side, holder: Message, memory: Memory = NOTHING_KEPT) -> tuple[Rule, ...]:
    """The rules that a message of a wire runs, with the wire's own message in place of that of all wires.

    What they need of the other wires' last messages is what ``memory`` has of them.
    """
    cut = cutter(holder)
    owners = owners_of(rules, cut) if target == "holder" else {}
    waits = _waits(rules, owners, cut) if memory.arrived else {}
    needs = {id(rule): each for rule, each in with_needs(rules, target)}
    return tuple(_Chosen(wire, target, memory, cut, owners, waits, needs).of(rules, NOTHING_AROUND, frozenset([wire])))


@dataclass(frozen=True, slots=True)
class _Chosen:
    """The choice of the rules for one wire's messages.

    Attributes
    ----------
    owners, waits, needs
        What `owners_of`, `_waits` and `with_needs` find; the last by the ids of rules.
    """

    wire: str
    target: Side
    memory: Memory
    cut: Callable[[Place], Names]
    owners: dict[Names, frozenset[Wires]]
    waits: dict[Names, Wires]
    needs: dict[int, Needs]

    def of(self, rules: tuple[Rule, ...], around: Needs, come: Wires) -> Iterator[Rule]:
        """Those of some rules that run, where the wires that have ``come`` are known to have sent a message."""
        for rule in rules:
            needs, own = around.within(rule, self.target), of_wire(rule, self.wire, self.memory)
            read = wires_read(own_expressions(rule)) - asked_for(needs.exprs)
            missing = (self.needed(rule, around) | read) - come if self.memory.arrived else NO_WIRE
            match own:
                case For(body=body):
                    inner = tuple(self.of(body, needs, come | missing))
                    found = (replace(own, body=inner),) if inner else ()
                case When(then=then, otherwise=otherwise):
                    chosen, other = (tuple(self.of(each, needs, come | missing)) for each in (then, otherwise))
                    found = (replace(own, then=chosen, otherwise=other),) if chosen or other else ()
                case _:
                    found = (own,) if self.is_run(rule, self.needs[id(rule)]) else ()
            for each in sorted(missing) if found else ():
                found = (When(self.memory.arrived[each], found, (), rule.span),)
            yield from found

    def is_run(self, rule: Rule, needs: Needs) -> bool:
        """Whether a rule that is no block runs."""
        if needs.wires:
            return self.wire in needs.runs_at
        set_ = [self.owners.get(self.cut(place), frozenset[Wires]()) for place in places_in((rule,))]
        return all(len(groups) != 1 or all(self.wire in each for each in groups) for groups in set_)

    def needed(self, rule: Rule, around: Needs) -> Wires:
        """The wires without a message of which nothing in a rule runs."""
        needs = around.within(rule, self.target)
        match rule:
            case For(body=inner):
                pass
            case When(then=then, otherwise=otherwise):
                inner = (*then, *otherwise)
            case _:
                return needs.waits_for.union(*(self.waits.get(self.cut(place), NO_WIRE) for place in places_in((rule,))))
        first, *rest = [self.needed(each, needs) for each in inner] or [NO_WIRE]
        return first.intersection(*rest)


def _waits(rules: tuple[Rule, ...], owners: dict[Names, frozenset[Wires]], cut: Callable[[Place], Names]) -> dict[Names, Wires]:
    """The wires that must have sent a message before any rule of a field runs: its array would have elements that nothing has set.

    The elements of an array that is joined are zeros until then.
    """
    found: dict[Names, Wires] = {}
    for rule, needs in with_needs(rules, "holder"):
        for place in places_in((rule,)):
            names = cut(place)
            if len(owners.get(names, ())) == 1:
                found[names] = found.get(names, NO_WIRE) | needs.waits_for
    return found


def of_wire(rule: Rule, wire: str, memory: Memory = NOTHING_KEPT) -> Rule:
    """A rule without the blocks within it, as it looks at one wire's message itself."""

    def seen(expr: Expr) -> Expr:
        return value_of_wire(expr, wire, memory)

    match rule:
        case Assign(place, value) | SetLength(place, value):
            return replace(rule, place=_without_wire(placed(place, seen)), value=seen(value))
        case Default(place) | Ignore(place):
            return replace(rule, place=_without_wire(place))
        case For(_, start, stop, _, kept=kept):
            count = None if kept is None or kept.count is None else seen(kept.count)
            filtered = None if kept is None else replace(kept, condition=seen(kept.condition), count=count)
            return replace(rule, start=seen(start), stop=seen(stop), kept=filtered)
        case When(condition):
            return replace(rule, condition=seen(condition))
        case Reject(pieces=pieces):
            return replace(rule, pieces=tuple(map(seen, pieces)))
        case SetState(_, value):
            return replace(rule, value=seen(value))
        case _:
            assert_never(rule)


def value_of_wire(expr: Expr, wire: str, memory: Memory = NOTHING_KEPT) -> Expr:
    """What is computed at a message of one wire: of that message, and of what ``memory`` has of others."""
    known = remembered(expr, wire, memory)
    if known is not None:
        return known
    if isinstance(expr, typed.Has) and asks_arrival(expr):
        (arrived,) = wire_of(expr.place)
        return typed.Const(True, typed.BOOL, expr.span) if arrived == wire else memory.arrived.get(arrived, expr)
    found = rebuilt(expr, lambda part: value_of_wire(part, wire, memory))
    match found:
        case typed.Access(place) | typed.LenOf(place) | typed.IsText(place) | typed.Has(place) | typed.Search(place):
            return replace(found, place=_without_wire(place))
        case _:
            return found


def _without_wire(place: Place) -> Place:
    return replace(place, steps=place.steps[1:]) if place.side == "wire" else place
