"""Whether lanes of two types may stand for each other: the same fields in the same places, whatever their structs are called."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.model.layout import Layout, Members, Number, Row, Span, Variant

if TYPE_CHECKING:
    from rosetta_jit.model.layout import Slot


def have_same_fields(one: Layout, other: Layout) -> bool:
    """Whether two layouts differ in the names of structs at most."""
    return _without_names(one) == _without_names(other)


def _without_names(layout: Layout) -> Layout:
    lanes = tuple(replace(lane, element=_slot(lane.element)) for lane in layout.lanes)
    return Layout(lanes, tuple((lane, "") for lane, _ in layout.recursive))


def _slot(slot: Slot) -> Slot:
    match slot:
        case Number() | Span():
            return slot
        case Row():
            return replace(slot, struct="", members=_members(slot.members))
        case Variant():
            return replace(slot, members=_members(slot.members))
        case _:
            assert_never(slot)


def _members(members: Members) -> Members:
    return Members(replace(each, slot=_slot(each.slot)) for each in members)
