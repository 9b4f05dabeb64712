"""Mappings of several wires: which rules a message of each wire runs, and which part of the holder is its share.

Such a mapping is checked like any other: its wire is one message with a field for each wire (`message_of_wires`). A message of a wire then
runs the rules that read that wire, and those that read none. What it fills is cleared before, and nothing else is touched; so a field
belongs to one wire, but for arrays of numbers whose elements several wires set: those are *joined*.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.catalogue import wires as words
from rosetta_jit.language import typed
from rosetta_jit.language.algebra.normal_form import rebuilt
from rosetta_jit.language.places import places_in, shown_names
from rosetta_jit.language.typed import Assign, Default, FieldStep, For, Ignore, IndexStep, Reject, SetLength, SetState, When
from rosetta_jit.language.untouched import places_read
from rosetta_jit.model.layout import recursive_structs
from rosetta_jit.model.types import Array, Bool, Enum, Field, Float, Int, Ref, Schema, Struct, same_name
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.language.scope import Message
    from rosetta_jit.language.typed import Expr, Place, Rule
    from rosetta_jit.model import mapping as model
    from rosetta_jit.model.expr import Side
    from rosetta_jit.source import Span

Names = tuple[str, ...]
Wires = frozenset[str]
"""The wires that a rule reads, or, of a rule to pack, the one that it sets."""

NO_WIRE: Wires = frozenset()


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


def _told(rules: tuple[Rule, ...], target: Side, around: Wires = NO_WIRE) -> Iterator[tuple[Rule, Wires]]:
    """Each rule that is no block, with its wires; the conditions and bounds of the blocks around it count."""
    for rule in rules:
        match rule:
            case For(body=body):
                yield from _told(body, target, around | _wires_of(rule, target))
            case When(then=then, otherwise=otherwise):
                yield from _told((*then, *otherwise), target, around | _wires_of(rule, target))
            case _:
                yield rule, around | _wires_of(rule, target)


def _wires_of(rule: Rule, target: Side) -> Wires:
    """The wires that a rule itself is of."""
    places = [rule.place] if isinstance(rule, Assign | SetLength | Default | Ignore) else []
    if target == "holder":
        places = [each for each in (*places, *(read for expr in _own(rule) for read in places_read(expr))) if each.side == "wire"]
    elif isinstance(rule, Ignore):
        places = []
    return frozenset(step.field.name for place in places for step in place.steps[:1] if isinstance(step, FieldStep))


def _own(rule: Rule) -> tuple[Expr, ...]:
    """The expressions that a rule computes itself."""
    match rule:
        case Assign(place, value) | SetLength(place, value):
            return (value, *(step.index for step in place.steps if isinstance(step, IndexStep)))
        case For(_, start, stop, _, kept=kept):
            filtered = () if kept is None else (kept.condition, *(() if kept.count is None else (kept.count,)))
            return (start, stop, *filtered)
        case When(condition):
            return (condition,)
        case Reject(pieces=pieces):
            return pieces
        case SetState(_, value):
            return (value,)
        case Default() | Ignore():
            return ()
        case _:
            assert_never(rule)


def rules_of(rules: tuple[Rule, ...], wire: str, target: Side, holder: Message) -> tuple[Rule, ...]:
    """The rules that a message of a wire runs, with the wire's own message in place of that of all wires."""
    cut = _cutter(holder)
    owners = _owners(rules, cut) if target == "holder" else {}

    def is_run(rule: Rule, wires: Wires) -> bool:
        if wires:
            return wire in wires
        set_ = [owners.get(cut(place), NO_WIRE) for place in places_in((rule,))]
        return all(len(each) != 1 or wire in each for each in set_)

    def kept(inner: tuple[Rule, ...], around: Wires) -> Iterator[Rule]:
        for rule in inner:
            wires = around | _wires_of(rule, target)
            match rule:
                case For(body=body):
                    if within := tuple(kept(body, wires)):
                        yield replace(_of_wire(rule), body=within)
                case When(then=then, otherwise=otherwise):
                    chosen, other = tuple(kept(then, wires)), tuple(kept(otherwise, wires))
                    if chosen or other:
                        yield replace(_of_wire(rule), then=chosen, otherwise=other)
                case _ if is_run(rule, wires):
                    yield _of_wire(rule)
                case _:
                    pass

    return tuple(kept(rules, NO_WIRE))


def _of_wire(rule: Rule) -> Rule:
    """A rule that looks at one wire's message itself."""
    match rule:
        case Assign(place, value) | SetLength(place, value):
            return replace(rule, place=_place(place), value=_expr(value))
        case Default(place) | Ignore(place):
            return replace(rule, place=_place(place))
        case For(_, start, stop, _, kept=kept):
            count = None if kept is None or kept.count is None else _expr(kept.count)
            filtered = None if kept is None else replace(kept, condition=_expr(kept.condition), count=count)
            return replace(rule, start=_expr(start), stop=_expr(stop), kept=filtered)
        case When(condition):
            return replace(rule, condition=_expr(condition))
        case Reject(pieces=pieces):
            return replace(rule, pieces=tuple(map(_expr, pieces)))
        case SetState(_, value):
            return replace(rule, value=_expr(value))
        case _:
            assert_never(rule)


def _expr(expr: Expr) -> Expr:
    found = rebuilt(expr, _expr)
    match found:
        case typed.Access(place) | typed.LenOf(place) | typed.IsText(place) | typed.Has(place) | typed.Search(place):
            return replace(found, place=_without_wire(place))
        case typed.HostCall(_, arguments):
            return replace(found, arguments=tuple(map(_expr, arguments)))
        case typed.Choice(pieces=pieces):
            return replace(found, pieces=tuple(map(_expr, pieces)))
        case _:
            return found


def _place(place: Place) -> Place:
    """A place that a rule sets; its indices are read."""
    steps = tuple(replace(step, index=_expr(step.index)) if isinstance(step, IndexStep) else step for step in place.steps)
    return _without_wire(replace(place, steps=steps))


def _without_wire(place: Place) -> Place:
    return replace(place, steps=place.steps[1:]) if place.side == "wire" else place


# --- which fields are whose ----------------------------------------------------------------------------------------------


def share_of(rules: tuple[Rule, ...], wire: str, wires: Sequence[str], holder: Message) -> Share:
    """What a message of one of the wires fills, of all rules to unpack."""
    cut = _cutter(holder)
    owners = _owners(rules, cut)
    mine = {cut(place) for place in places_in(rules_of(rules, wire, "holder", holder))}
    joined = frozenset(names for names in mine if len(owners.get(names, NO_WIRE)) > 1)
    others = {names for names, wires in owners.items() if wires != frozenset([wire])}
    around = {names[:count] for names in mine - joined for count in range(1, len(names))}
    alone = (names for names in around if not any(other[: len(names)] == names for other in others))
    return Share(wires.index(wire), frozenset(mine) - joined, frozenset(alone), joined)


def _owners(rules: tuple[Rule, ...], cut: Callable[[Place], Names]) -> dict[Names, Wires]:
    """The wires that set each field, as far as it is no message, or one that can contain itself."""
    found: dict[Names, Wires] = {}
    for rule, wires in _told(rules, "holder"):
        for place in places_in((rule,)):
            names = cut(place)
            found[names] = found.get(names, NO_WIRE) | wires
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
    every = list(_told(rules, target))
    problems = [words.apart(rule.span, sorted(wires)) for rule, wires in every if len(wires) > 1]
    return problems or (_overlaps(rules, every, holder) if target == "holder" else [])


def _overlaps(rules: tuple[Rule, ...], every: list[tuple[Rule, Wires]], holder: Message) -> list[Diagnostic]:
    problems: list[Diagnostic] = []
    cut = _cutter(holder)
    shared = [names for names, wires in _owners(rules, cut).items() if len(wires) > 1]
    for names in shared:
        mine = [(rule, wires, place) for rule, wires in every for place in places_in((rule,)) if cut(place) == names]
        if _can_be_joined(names, mine, holder):
            continue
        first: tuple[str, Span | None] | None = None
        for rule, wires, _ in mine:
            for wire in wires:
                if first is None:
                    first = wire, rule.span
                elif wire != first[0]:
                    problems.append(words.set_by_several(rule.span, shown_names(names, holder), (first[0], wire), first[1]))
                    break
    return problems


def _can_be_joined(names: Names, mine: list[tuple[Rule, Wires, Place]], holder: Message) -> bool:
    """Whether a field is an array of numbers, whose length no wire tells, and of which wires set single elements."""
    last = next(step.field for _, _, place in mine for step in place.steps[len(names) - 1 : len(names)] if isinstance(step, FieldStep))
    type_ = holder.value_type(last.type)
    if not isinstance(type_, Array) or not isinstance(holder.value_type(type_.element), Bool | Int | Float | Enum):
        return False
    elements = [(rule, place) for rule, wires, place in mine if wires]
    lengths = [rule for rule, wires, _ in mine if not wires and isinstance(rule, SetLength)]
    is_told = isinstance(type_.length, int) or bool(lengths)
    whole = [rule for rule, wires, place in mine if not wires and isinstance(rule, Assign) and len(place.steps) == len(names)]
    return is_told and not whole and all(isinstance(rule, Assign) and len(place.steps) == len(names) + 1 for rule, place in elements)
