"""Mappings of several wires: which rules a message of each wire runs, and which part of the holder is its share.

Such a mapping is checked like any other: its wire is one message with a field for each wire (`message_of_wires`). A message of a wire
then runs the rules that read that wire, and those that read none; a rule that reads several runs where it can be computed
(`check.across_wires`). What a message fills is cleared before, and nothing else is touched; so all rules of a field run at messages of the
same wires, but for arrays of numbers whose elements several wires set: those are *joined*.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.catalogue import wires as words
from rosetta_jit.language import typed
from rosetta_jit.language.check.across_wires import (
    NOTHING_KEPT,
    Wires,
    asked_for,
    remembered,
    runs_at,
    values_of_others,
    wire_of,
    wires_read,
)
from rosetta_jit.language.places import places_in, shown_names, shown_place
from rosetta_jit.language.typed import Assign, Default, FieldStep, For, Ignore, Reject, SetLength, SetState, When
from rosetta_jit.language.untouched import asks_arrival
from rosetta_jit.language.walk import expressions_of, placed, rebuilt
from rosetta_jit.model.layout import recursive_structs
from rosetta_jit.model.types import Array, Bool, Enum, Field, Float, Int, Ref, Schema, Struct, same_name
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.language.check.across_wires import Memory
    from rosetta_jit.language.scope import Message
    from rosetta_jit.language.typed import Expr, Place, Rule
    from rosetta_jit.model import mapping as model
    from rosetta_jit.model.expr import Side
    from rosetta_jit.model.types import Type
    from rosetta_jit.source import Span

Names = tuple[str, ...]
NO_WIRE: frozenset[str] = frozenset()


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


def message_of_wires(mapping: model.Mapping, schema: Schema) -> Schema:
    """The schema with the message that has a field for each wire; without it where a wire's type is unknown."""
    found = {each.name: next((name for name in schema.types if same_name(name, each.type)), None) for each in mapping.wires}
    fields = tuple(Field(name, Ref(type_)) for name, type_ in found.items() if type_ is not None)
    if not fields or len(fields) < len(found):
        return schema
    types = {**schema.types, mapping.wire_type: Struct(mapping.wire_type, fields)}
    return Schema(types, schema.sources, schema.constants, schema.left_out)


# --- which rules are whose -----------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Nested:
    """What a rule says, with the blocks around it.

    Attributes
    ----------
    read
        The wires that it reads; of a rule to pack, the one that it sets.
    exprs
        What it computes.
    others
        All wires, of a rule that asks what has arrived: it runs at messages of any.
    """

    read: Wires = NO_WIRE
    exprs: tuple[Expr, ...] = ()
    others: Wires = NO_WIRE

    def within(self, rule: Rule, target: Side) -> _Nested:
        """The same with one more rule."""
        places = [rule.place] if isinstance(rule, Assign | SetLength | Default | Ignore) else []
        exprs = _own(rule) if target == "holder" else ()
        set_ = () if target == "wire" and isinstance(rule, Ignore) else tuple(map(wire_of, places))
        return _Nested(self.read.union(wires_read(exprs), *set_), (*self.exprs, *exprs))

    @property
    def wires(self) -> Wires:
        """The wires on whose messages it depends."""
        return self.read | self.others

    @property
    def runs_at(self) -> Wires:
        """The wires at whose messages the rule runs; none of one that runs at all of them, or at none."""
        return self.wires if len(self.wires) < 2 else runs_at(self.exprs, self.wires)

    @property
    def waits_for(self) -> Wires:
        """The wires that must have sent a message before the rule runs."""
        return self.read - asked_for(self.exprs)


NOTHING_AROUND = _Nested()


def _with_needs(rules: tuple[Rule, ...], target: Side) -> list[tuple[Rule, _Nested]]:
    """Each rule that is no block, of all of a direction, with what it reads."""
    found = list(_walked(rules, target))
    every = NO_WIRE.union(*(needs.read for _, needs in found))
    return [(rule, replace(needs, others=every) if asked_for(needs.exprs) else needs) for rule, needs in found]


def _walked(
    rules: tuple[Rule, ...], target: Side, around: _Nested = NOTHING_AROUND, *, chosen: bool = False
) -> Iterator[tuple[Rule, _Nested]]:
    """Each rule that is no block, with what it reads; the conditions and bounds of the blocks around it count.

    Rules of one place that conditions choose among, ``chosen`` ones, are as one: each of them reads what all of them read.
    """
    for rule in rules:
        within = around.within(rule, target)
        match rule:
            case For(body=body):
                yield from _walked(body, target, within, chosen=chosen)
            case When(then=then, otherwise=otherwise):
                inner = _walked((*then, *otherwise), target, within, chosen=True)
                yield from inner if chosen else _as_one(list(inner))
            case _:
                yield rule, within


def _as_one(chosen: list[tuple[Rule, _Nested]]) -> Iterator[tuple[Rule, _Nested]]:
    together: dict[str, tuple[Wires, dict[int, Expr]]] = {}
    for rule, needs in chosen:
        for place in places_in((rule,)):
            wires, exprs = together.get(shown_place(place.steps), (NO_WIRE, dict[int, "Expr"]()))
            together[shown_place(place.steps)] = wires | needs.read, exprs | {id(each): each for each in needs.exprs}
    for rule, needs in chosen:
        found = [together[shown_place(place.steps)] for place in places_in((rule,))]
        yield rule, _Nested(found[0][0], tuple(found[0][1].values())) if found else needs


def _own(rule: Rule) -> tuple[Expr, ...]:
    """The expressions that a rule computes itself, and how many rounds of a loop are kept."""
    count = rule.kept.count if isinstance(rule, For) and rule.kept is not None else None
    return (*expressions_of(rule), *(() if count is None else (count,)))


def kept_values(rules: tuple[Rule, ...]) -> list[tuple[str, Expr]]:
    """What rules to unpack that read several wires need of other messages than the one at hand: each with its wire."""
    found = [
        value for _, needs in _with_needs(rules, "holder") if len(needs.wires) > 1 for value in values_of_others(needs.exprs, needs.wires)
    ]
    return [(wire, value) for value in dict.fromkeys(found) for wire in wires_read([value])]


def rules_of(rules: tuple[Rule, ...], wire: str, target: Side, holder: Message, memory: Memory = NOTHING_KEPT) -> tuple[Rule, ...]:
    """The rules that a message of a wire runs, with the wire's own message in place of that of all wires.

    What they need of the other wires' last messages is what ``memory`` has of them.
    """
    cut = _cutter(holder)
    owners = _owners(rules, cut) if target == "holder" else {}
    waits = _waits(rules, owners, cut) if memory.arrived else {}
    needs = {id(rule): each for rule, each in _with_needs(rules, target)}
    return tuple(_Chosen(wire, target, memory, cut, owners, waits, needs).of(rules, NOTHING_AROUND, frozenset([wire])))


@dataclass(frozen=True, slots=True)
class _Chosen:
    """The choice of the rules for one wire's messages.

    Attributes
    ----------
    owners, waits, told
        What `_owners`, `_waits` and `_told` find; the last by the ids of rules.
    """

    wire: str
    target: Side
    memory: Memory
    cut: Callable[[Place], Names]
    owners: dict[Names, frozenset[Wires]]
    waits: dict[Names, Wires]
    needs: dict[int, _Nested]

    def of(self, rules: tuple[Rule, ...], around: _Nested, come: Wires) -> Iterator[Rule]:
        """Those of some rules that run, where the wires that have ``come`` are known to have sent a message."""
        for rule in rules:
            needs, own = around.within(rule, self.target), of_wire(rule, self.wire, self.memory)
            read = wires_read(_own(rule)) - asked_for(needs.exprs)
            others = (self.needed(rule, around) | read) - come if self.memory.arrived else NO_WIRE
            match own:
                case For(body=body):
                    inner = tuple(self.of(body, needs, come | others))
                    found = (replace(own, body=inner),) if inner else ()
                case When(then=then, otherwise=otherwise):
                    chosen, other = (tuple(self.of(each, needs, come | others)) for each in (then, otherwise))
                    found = (replace(own, then=chosen, otherwise=other),) if chosen or other else ()
                case _:
                    found = (own,) if self.is_run(rule, self.needs[id(rule)]) else ()
            for each in sorted(others) if found else ():
                found = (When(self.memory.arrived[each], found, (), rule.span),)
            yield from found

    def is_run(self, rule: Rule, needs: _Nested) -> bool:
        """Whether a rule that is no block runs."""
        if needs.wires:
            return self.wire in needs.runs_at
        set_ = [self.owners.get(self.cut(place), frozenset[Wires]()) for place in places_in((rule,))]
        return all(len(groups) != 1 or all(self.wire in each for each in groups) for groups in set_)

    def needed(self, rule: Rule, around: _Nested) -> Wires:
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
    for rule, needs in _with_needs(rules, "holder"):
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


# --- which fields are whose ----------------------------------------------------------------------------------------------


def share_of(rules: tuple[Rule, ...], wire: str, wires: Sequence[str], holder: Message) -> Share:
    """What a message of one of the wires fills, of all rules to unpack."""
    cut = _cutter(holder)
    owners = _owners(rules, cut)
    mine = {cut(place) for place in places_in(rules_of(rules, wire, "holder", holder))}
    joined = frozenset(names for names in mine if len(owners.get(names, ())) > 1)
    others = {names for names, groups in owners.items() if len(groups) != 1 or any(wire not in each for each in groups)}
    around = {names[:count] for names in mine - joined for count in range(1, len(names))}
    alone = (names for names in around if not any(other[: len(names)] == names for other in others))
    return Share(wires.index(wire), frozenset(mine) - joined, frozenset(alone), joined)


def _owners(rules: tuple[Rule, ...], cut: Callable[[Place], Names]) -> dict[Names, frozenset[Wires]]:
    """The wires at whose messages the rules of each field run, as far as it is no message, or one that can contain itself.

    All rules of most fields run at messages of the same wires; a field whose rules do not has several sets of wires.
    """
    found: dict[Names, frozenset[Wires]] = {}
    for rule, needs in _with_needs(rules, "holder"):
        for place in places_in((rule,)):
            names = cut(place)
            found[names] = found.get(names, frozenset[Wires]()) | ({needs.runs_at} if needs.wires else frozenset[Wires]())
    return found


def _cutter(holder: Message) -> Callable[[Place], Names]:
    """What gives the way to a place up to the first field that has a lane of its own, is one of several cases, or is a number."""
    recursive = recursive_structs(Ref(holder.root.name), holder.schema)

    def cut(place: Place) -> Names:
        names: list[str] = []
        for step in place.steps:
            if not isinstance(step, FieldStep):
                break
            names.append(step.field.name)
            type_ = holder.value_type(step.field.type)
            if not isinstance(type_, Struct) or type_.name in recursive:
                break
        return tuple(names)

    return cut


# --- what is wrong with them ---------------------------------------------------------------------------------------------


def wrong_wires(rules: tuple[Rule, ...], target: Side, holder: Message) -> list[Diagnostic]:
    """Reports of rules that need several wires at once, and, of rules to unpack, of fields that several wires set."""
    every = _with_needs(rules, target)
    problems = [words.apart(rule.span, sorted(needs.wires)) for rule, needs in every if needs.wires and not needs.runs_at]
    return problems or (_overlaps(rules, every, holder) if target == "holder" else [])


def _overlaps(rules: tuple[Rule, ...], every: list[tuple[Rule, _Nested]], holder: Message) -> list[Diagnostic]:
    problems: list[Diagnostic] = []
    cut = _cutter(holder)
    shared = [names for names, groups in _owners(rules, cut).items() if len(groups) > 1]
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
    """Whether a field is an array of numbers, whose length no wire tells, and of which wires set single elements."""
    type_ = _type_at(names, mine, holder)
    if not isinstance(type_, Array) or not isinstance(holder.value_type(type_.element), Bool | Int | Float | Enum):
        return False
    elements = [(rule, place) for rule, wires, place in mine if wires]
    lengths = [rule for rule, wires, _ in mine if not wires and isinstance(rule, SetLength)]
    is_told = isinstance(type_.length, int) or bool(lengths)
    whole = [rule for rule, wires, place in mine if not wires and isinstance(rule, Assign) and len(place.steps) == len(names)]
    return is_told and not whole and all(isinstance(rule, Assign) and len(place.steps) == len(names) + 1 for rule, place in elements)
