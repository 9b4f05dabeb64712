"""The share of a holder that messages of one of several wires fill: it is cleared before the rules run, and all else is kept.

Of an array of texts that several wires set elements of, all texts are kept. They lie one behind another, so that each message moves them to
the front of their lane and sets its own behind them: a lane does not grow with the number of messages.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from rosetta_jit.kernel.nodes import (
    Assign,
    Binary,
    Capacity,
    Compare,
    Const,
    Copy,
    Expr,
    For,
    Get,
    If,
    Local,
    Place,
    Scalar,
    SetField,
    Used,
)
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.language.check.wire_needs import Names
from rosetta_jit.language.check.wire_shares import Share
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.codec.holder_fields import HolderFields, member_of, presence_bit, span_of
from rosetta_jit.lowering.rules.initial_values import lanes_below
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.model.initial_values import InitialValue
from rosetta_jit.model.layout import Layout, Number, Row, Slot, Span, Variant
from rosetta_jit.wire.codec import Path


def kept_lanes(share: Share, layout: Layout) -> tuple[int, ...]:
    """The lanes whose rows stay: all but those of what is cleared, and of texts, which are moved."""
    emptied = set[int]().union(*(lanes_below(_slot_at(names, layout), layout) for names in share.cleared))
    arrays = (_slot_at(names, layout) for names in share.joined)
    emptied |= {lane for slot in arrays if isinstance(slot, Span) for lane in lanes_below(layout.lanes[slot.lane].element, layout)}
    return tuple(lane for lane in range(len(layout.lanes)) if lane not in emptied)


def clear(fields: HolderFields, share: Share) -> None:
    """Let the share be as it is in an empty message."""
    for names in sorted(share.alone):
        _leave(fields, names)
    for names in sorted(share.cleared):
        _leave(fields, names)
        _clear(fields, _slot_at(names, fields.layout))


def fixed_arrays(share: Share, layout: Layout, opened: frozenset[int]) -> list[Names]:
    """The arrays with elements of several wires whose lengths no rule sets."""
    slots = [(names, _slot_at(names, layout)) for names in sorted(share.joined)]
    return [names for names, slot in slots if isinstance(slot, Span) and slot.lane not in opened]


def keep_texts(fields: HolderFields, path: Path) -> None:
    """Move the texts of an array to the front of their lane, which is empty when the kernel starts, but has its bytes still.

    They are copied in two steps, since one's new place may be another's old one. Nothing can fail once the first is moved, so that a kernel
    which runs again for want of room finds all of them. A message that failed may have left any span behind: one that lies nowhere becomes
    empty.
    """
    text = fields.layout.lanes[span_of(fields.find(path)).lane].element
    if not isinstance(text, Span):
        return
    writer, lane, stored = fields.writer, text.lane, fields.stored(path)
    aside = writer.lane(f"texts of {path[-1]}", fields.layout.lanes[lane].stride)

    def each(do: Callable[[Place, Place], None]) -> None:
        number = Local("i64", writer.fresh("text"))
        cell = fields.elements(path, stored).at(number).cell
        with writer.nested() as body:
            do(cell.place(text.offset), cell.place(text.offset + 8))
        writer.emit(For(number.name, stored.size, block(body)))

    each(lambda start, size: _put_aside(fields, lane, (start, size), aside))
    size = writer.let("size", Used(aside))
    front = fields.reserve(lane, size)
    writer.emit(Copy(Place(lane, front), Place(aside, index(0)), mul(size, fields.layout.lanes[lane].stride)))
    behind = writer.var("behind", front)
    each(lambda start, size: _place_behind(writer, lane, (start, size), behind))


def _put_aside(fields: HolderFields, lane: int, span: tuple[Place, Place], aside: int) -> None:
    """Copy a text to a lane, behind others; let its count be 0 where it lies nowhere."""
    writer, (at, count) = fields.writer, span
    start, size = writer.let("start", Get("i64", at)), writer.let("size", Get("i64", count))
    with writer.nested() as copied:
        first = fields.reserve(aside, size)
        writer.emit(Copy(Place(aside, first), Place(lane, start), mul(size, fields.layout.lanes[lane].stride)))
    nowhere = (SetField(count, index(0)),)
    begins = _is_within(start, Binary("sub", Capacity(lane), size))
    writer.emit(If(_is_within(size, Capacity(lane)), (If(begins, block(copied), nowhere),), nowhere))


def _place_behind(writer: Writer, lane: int, span: tuple[Place, Place], behind: Local) -> None:
    """Let a text begin behind the one before."""
    start, count = span
    size = writer.let("size", Get("i64", count))
    writer.emit(SetField(start, behind))
    ends = Binary("and", _is_within(size, Capacity(lane)), _is_within(behind, Capacity(lane)))  # true anyway; said for the proof
    writer.emit(If(ends, (Assign(behind.name, add(behind, size)),)))


def _is_within(value: Expr, most: Expr) -> Expr:
    return Binary("and", Compare("ge", value, index(0)), Compare("le", value, most))


def initial_of(share: Share, initial: tuple[InitialValue, ...], layout: Layout) -> tuple[InitialValue, ...]:
    """The initial values of the share, of those of a message."""
    words = {word for names in share.cleared for word in _words(_slot_at(names, layout))}
    return tuple(each for each in initial if each.word in words)


def _slot_at(names: Names, layout: Layout) -> Slot:
    slot = layout.root
    for name in names:
        slot = member_of(slot, name).slot
    return slot


def _words(slot: Slot) -> list[int]:
    """The words of a row that spans, and the cases of unions, lie in, as initial values name them."""
    match slot:
        case Number():
            return []
        case Span(offset):
            return [offset // 8]
        case Row(members=members):
            return [word for member in members for word in _words(member.slot)]
        case Variant(offset, members):
            return [offset // 8, *(word for member in members for word in _words(member.slot))]
        case _:
            assert_never(slot)


def _leave(fields: HolderFields, names: Names) -> None:
    """Let a field be absent, if it can be."""
    owner = fields.find(names[:-1])
    member = member_of(owner.slot, names[-1])
    if isinstance(owner.slot, Row) and member.presence is not None:
        place, mask = presence_bit(owner, owner.slot, member.presence)
        other_bits = Const("u64", (1 << 64) - 1 - int(mask.value))
        fields.writer.emit(SetField(place, Binary("and", Get("u64", place), other_bits)))


def _clear(fields: HolderFields, slot: Slot) -> None:
    place, writer = fields.cell.place, fields.writer
    match slot:
        case Number(offset, scalar):
            writer.emit(SetField(place(offset), _zero(scalar_name(scalar))))
        case Span(offset):
            writer.emit(SetField(place(offset), index(0)), SetField(place(offset + 8), index(0)))
        case Row(offset, _, presence_words, members, unknown):
            writer.emit(*(SetField(place(offset + 8 * number), Const("u64", 0)) for number in range(presence_words)))
            for inner in (*(() if unknown is None else (unknown,)), *(member.slot for member in members)):
                _clear(fields, inner)
        case Variant(offset, members):
            writer.emit(SetField(place(offset), index(0)))
            for member in members:
                _clear(fields, member.slot)
        case _:
            assert_never(slot)


def _zero(scalar: Scalar) -> Const:
    return Const(scalar, value=False if scalar == "bool" else 0.0 if scalar in ("f32", "f64") else 0)
