"""Initial values of new rows, where rules set their parts one by one: fixed arrays whose elements get values, unions' first cases.

An array that a rule gives a length, or sets as a whole, is opened there; all others must have their elements before the rules begin.
"""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.kernel.nodes import Expr, Fill, For, Local, Place, SetField
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.language import typed
from rosetta_jit.language.places import rules_within
from rosetta_jit.lowering.codec.holder_fields import HolderFields, member_of
from rosetta_jit.lowering.writer import block
from rosetta_jit.model.initial_values import FirstCase, FixedArray, InitialValue
from rosetta_jit.model.layout import Layout, Number, Row, Slot, Span, Variant


def initialise(fields: HolderFields, initial: tuple[InitialValue, ...], row: Expr, opened: frozenset[int]) -> None:
    """Give a row its initial values, but for what lies in ``opened`` lanes."""
    writer = fields.writer
    for each in initial:
        match each:
            case FixedArray(lane, word, target, length, within, _) if target not in opened:
                first = fields.reserve(target, index(length))
                writer.emit(
                    SetField(Place(lane, row, 8 * word), first),
                    SetField(Place(lane, row, 8 * word + 8), index(length)),
                    Fill(Place(target, first), index(length * fields.layout.lanes[target].stride)),
                )
                initialise_each(fields, within, first, index(length), opened)
            case FixedArray():
                pass
            case FirstCase(lane, word, number):
                writer.emit(SetField(Place(lane, row, 8 * word), index(number)))
            case _:
                assert_never(each)


def initialise_each(fields: HolderFields, initial: tuple[InitialValue, ...], first: Expr, count: Expr, opened: frozenset[int]) -> None:
    """The same for so many rows."""
    writer = fields.writer
    number = Local("i64", writer.fresh("row"))
    with writer.nested() as body:
        initialise(fields, initial, add(first, number), opened)
    if body:
        writer.emit(For(number.name, count, block(body)))


def opened_lanes(rules: tuple[typed.Rule, ...], layout: Layout, root: Slot, side: str) -> frozenset[int]:
    """The lanes whose rows rules take themselves: those of lengths that they set, and below what they set as a whole."""
    found: set[int] = set()
    for rule in rules_within(rules):
        match rule:
            case typed.SetLength(place) if place.side == side:
                slot = _slot_at(place, layout, root)
                found.update([slot.lane] if isinstance(slot, Span) else [])
            case typed.Assign(place) if place.side == side:
                found.update(lanes_below(_slot_at(place, layout, root), layout))
            case _:
                pass
    return frozenset(found)


def _slot_at(place: typed.Place, layout: Layout, root: Slot) -> Slot:
    slot = root
    for step in place.steps:
        match step, slot:
            case typed.FieldStep(field), Span(_, lane):
                slot = member_of(layout.lanes[lane].element, field.name).slot
            case typed.FieldStep(field), _:
                slot = member_of(slot, field.name).slot
            case typed.IndexStep(), Span(_, lane):
                slot = layout.lanes[lane].element
            case _:
                raise AssertionError(step)
    return slot


def lanes_below(slot: Slot, layout: Layout, outer: frozenset[int] = frozenset()) -> set[int]:
    """The lanes that what lies at a slot has rows in."""
    match slot:
        case Number():
            return set()
        case Span(_, lane):
            return {lane} if lane in outer else {lane} | lanes_below(layout.lanes[lane].element, layout, outer | {lane})
        case Row(members=members) | Variant(members=members):
            unknown = slot.unknown if isinstance(slot, Row) else None
            inner = (*(() if unknown is None else (unknown,)), *(member.slot for member in members))
            return set[int]().union(*(lanes_below(each, layout, outer) for each in inner))
        case _:
            assert_never(slot)
