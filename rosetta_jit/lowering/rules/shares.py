"""The share of a holder that messages of one of several wires fill: it is cleared before the rules run, and all else is kept."""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.kernel.ir import Binary, Const, Get, Scalar, SetField
from rosetta_jit.kernel.terms import index
from rosetta_jit.language.check.wire_needs import Names
from rosetta_jit.language.check.wire_shares import Share
from rosetta_jit.lowering.codec.fields import HolderFields, member_of, presence_bit, scalar_name
from rosetta_jit.lowering.rules.initial_values import lanes_below
from rosetta_jit.model.initial_values import InitialValue
from rosetta_jit.model.layout import Layout, Number, Row, Slot, Span, Variant


def kept_lanes(share: Share, layout: Layout) -> tuple[int, ...]:
    """The lanes whose rows stay: all but those of what is cleared."""
    emptied = set[int]().union(*(lanes_below(_slot_at(names, layout), layout) for names in share.cleared))
    return tuple(lane for lane in range(len(layout.lanes)) if lane not in emptied)


def clear(fields: HolderFields, share: Share) -> None:
    """Let the share be as it is in an empty message."""
    for names in sorted(share.alone):
        _leave(fields, names)
    for names in sorted(share.cleared):
        _leave(fields, names)
        _clear(fields, _slot_at(names, fields.layout))


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
