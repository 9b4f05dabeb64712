"""Values of one type as a whole, from lanes to lanes: numbers, then what their spans lead to; what is absent stays absent."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel.ir import Binary, Compare, Const, Copy, For, Get, If, Local, Place, Switch
from rosetta_jit.kernel.terms import index, mul
from rosetta_jit.lowering.codec.fields import presence_bit
from rosetta_jit.lowering.limits import MAX_SIZE
from rosetta_jit.lowering.rules.rescaling import by_number, change_of_member, rescaled
from rosetta_jit.lowering.writer import block
from rosetta_jit.model.layout import Number, Row, Slot, Span, Variant

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Block
    from rosetta_jit.language.typed import Change
    from rosetta_jit.lowering.codec.fields import HolderFields
    from rosetta_jit.model.layout import Layout, Member
    from rosetta_jit.wire.codec import Path


def is_endless(layout: Layout, slot: Slot) -> bool:
    """Whether a value can hold others of its own type."""
    match slot:
        case Number():
            return False
        case Span(_, lane):
            return layout.lanes[lane].links is not None or is_endless(layout, layout.lanes[lane].element)
        case Row(members=members) | Variant(members=members):
            return any(is_endless(layout, member.slot) for member in members)
        case _:
            assert_never(slot)


def copy(source: HolderFields, origin: Path, target: HolderFields, path: Path, change: Change | None = None) -> None:
    """Copy the value at a path of one message to a path of another, which holds nothing there yet. It must not be endless.

    ``change`` says which numbers have another unit there.
    """
    slot = source.find(origin).slot
    match slot:
        case Number():
            value = source.get(origin)
            assert value is not None
            target.put(path, value if change is None else rescaled(value, change))
        case Span():
            _elements(source, origin, target, path, change)
        case Row(members=members):
            target.mark(path)
            for member in members:
                ends = (source, (*origin, member.name)), (target, (*path, member.name))
                _member(slot, member, *ends, change_of_member(change, member.name))
        case Variant(offset, members):
            case = source.writer.let("case", Get("i64", source.find(origin).place(offset)))
            changes = [change_of_member(change, member.name) for member in members]
            ways = enumerate(zip(members, changes, strict=True))
            cases = tuple((1 + number, _case(member, source, origin, target, path, within)) for number, (member, within) in ways)
            source.writer.emit(Switch(case, cases, ()))
        case _:
            assert_never(slot)


def _member(row: Row, member: Member, origin: tuple[HolderFields, Path], target: tuple[HolderFields, Path], change: Change | None) -> None:
    if member.presence is None:
        copy(*origin, *target, change)
        return
    source, path = origin
    place, mask = presence_bit(source.find(path[:-1]), row, member.presence)
    with source.writer.nested() as there:
        copy(*origin, *target, change)
    source.writer.emit(If(Compare("ne", Binary("and", Get("u64", place), mask), Const("u64", 0)), block(there)))


def _case(member: Member, source: HolderFields, origin: Path, target: HolderFields, path: Path, change: Change | None) -> Block:
    with source.writer.nested() as body:
        copy(source, (*origin, member.name), target, (*path, member.name), change)
    return block(body)


def _elements(source: HolderFields, origin: Path, target: HolderFields, path: Path, change: Change | None) -> None:
    writer, stored = source.writer, source.stored(origin)
    taken = source.elements(origin, stored)
    lane = source.layout.lanes[taken.lane]
    writer.expect(Compare("le", stored.size, index(MAX_SIZE // lane.stride)), "count", source.shown(origin), "too many elements")
    made = target.open(path, stored.size)
    if isinstance(lane.element, Number) and change is None:
        writer.emit(Copy(Place(made.lane, made.start), Place(taken.lane, taken.start), mul(stored.size, lane.stride)))
        return
    number = Local("i64", writer.fresh("each"))
    with writer.nested() as body:
        by_number(writer, change, number, lambda within: copy(taken.at(number), (), made.at(number), (), within))
    writer.emit(For(number.name, stored.size, block(body)))
