"""What every message has of an object: its containers and numbers that cannot be absent, and how they are reached."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.holder.rows import Struct as RowStruct
from rosetta_jit.generate.c.holder.rows import members_of
from rosetta_jit.generate.cpp.objects.spots import Direct, Spot
from rosetta_jit.model.layout import Number, Row, Slot, Span
from rosetta_jit.model.types import Array, Bytes, Enum, Ref, String, Struct, Type

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.objects.walk import Walk


def directs(walk: Walk, at: str) -> Iterator[Direct]:
    """Containers of numbers and texts, of an object that is called ``at``."""
    for found, span, row, inner in spans(walk, at):
        if isinstance(found, String | Bytes | Array) and is_plain(walk, found, span.lane):
            yield Direct(span.lane, row, Spot(walk.text("direct", inner), inner.owner, inner.field))


def spans(walk: Walk, at: str) -> Iterator[tuple[Type, Span, str, Spot]]:
    """What has a length: its type, where its span lies, what that is called in the row, and the field of the class."""
    return _spans(walk, Ref(walk.unit.type), walk.unit.layout.root, walk.lanes.all[0].element, "row", Spot(at))


def _spans(walk: Walk, type_: Type, slot: Slot, element: object, row: str, spot: Spot) -> Iterator[tuple[Type, Span, str, Spot]]:
    resolved = walk.unit.schema.resolve(type_)
    if not isinstance(resolved, Struct) or not isinstance(slot, Row) or not isinstance(element, RowStruct):
        return
    for each, name, member, own in zip(resolved.fields, walk.names(resolved), slot.members, members_of(element), strict=True):
        if member.presence is not None:
            continue
        found, at, inner = walk.unit.schema.resolve(each.type), f"{row}.{own.identifier}", walk.member_of(spot.at, name)
        if isinstance(member.slot, Span):
            yield found, member.slot, at, inner
        elif isinstance(found, Struct):
            yield from _spans(walk, found, member.slot, own.type, at, Spot(inner.at))


def numbers(walk: Walk, at: str) -> Iterator[tuple[int, str, Spot]]:
    """The numbers: where each lies in its row, what it is called there, and the field of the class."""
    return _numbers(walk, Ref(walk.unit.type), walk.unit.layout.root, walk.lanes.all[0].element, "row", at)


def _numbers(walk: Walk, type_: Type, slot: Slot, element: object, row: str, at: str) -> Iterator[tuple[int, str, Spot]]:
    resolved = walk.unit.schema.resolve(type_)
    if not isinstance(resolved, Struct) or not isinstance(slot, Row) or not isinstance(element, RowStruct):
        return
    for each, name, member, own in zip(resolved.fields, walk.names(resolved), slot.members, members_of(element), strict=True):
        inner, there = walk.member_of(at, name), f"{row}.{own.identifier}"
        if member.presence is None and isinstance(member.slot, Number):
            yield member.slot.offset, there, inner
        elif member.presence is None:
            yield from _numbers(walk, each.type, member.slot, own.type, there, inner.at)


def is_plain(walk: Walk, type_: String | Bytes | Array, lane: int) -> bool:
    """Whether a container has the very numbers that the lane has: enums are of another type, as bools often are."""
    element = walk.unit.layout.lanes[lane].element
    is_enum = isinstance(type_, Array) and isinstance(walk.unit.schema.resolve(type_.element), Enum)
    return isinstance(element, Number) and (element.scalar != "bool" or walk.manners.byte_flags) and not is_enum
