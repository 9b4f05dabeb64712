"""A tagged message while it is read: its presence bits, the cases of its unions, and where its arrays start."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import WIDTH, Binary, Compare, Const, Expr, Fill, Get, If, Local, Select, SetField, Used
from rosetta_jit.kernel.terms import index
from rosetta_jit.lowering.codec.fields import converted
from rosetta_jit.lowering.codec.holder_fields import HolderFields, span_of
from rosetta_jit.lowering.writer import Writer
from rosetta_jit.model.layout import UNKNOWN, Row, Slot, Span, Variant
from rosetta_jit.model.layout import Number as NumberSlot
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Path, Tagged


@dataclass(frozen=True, slots=True)
class Message:
    """A message that is being read: its fields, where it stops, its presence words, and where its arrays start.

    Of one that is whole or not at all, ``strange`` becomes true where it has a value that is not allowed.
    """

    writer: Writer
    fields: HolderFields
    tagged: Tagged
    stop: Expr
    presence: tuple[Local, ...]
    starts: dict[Path, Local]
    depth: Expr
    strange: Local | None = None


def presence_words(writer: Writer, fields: HolderFields, *, fresh: bool) -> tuple[Local, ...]:
    """Its presence bits while it is read: words that start as those of the row, or as zeros if the row is fresh."""
    row = row_of(fields)
    zero = Const("u64", 0)
    words = [fields.cell.place(row.offset + 8 * number) for number in range(row.presence_words)]
    return tuple(writer.var("present", zero if fresh else Get("u64", word)) for word in words)


def array_starts(writer: Writer, fields: HolderFields, tagged: Tagged, *, fresh: bool) -> dict[Path, Local]:
    """For each of its arrays, the row of the elements' lane with which it starts."""
    starts: dict[Path, Local] = {}
    kept = [(UNKNOWN,)] if row_of(fields).unknown is not None else []
    for path in (*kept, *(entry.path for entry in tagged.entries if entry.label != "single")):
        if path not in starts:
            span = span_of(fields.find(path))
            used = Used(span.lane)
            start: Expr = used
            if not fresh:
                known = writer.let("start", Get("i64", fields.cell.place(span.offset)))
                sane = Binary("and", Compare("ge", known, index(0)), Compare("le", known, used))
                writer.expect(sane, "length", fields.shown(path), "the holder is damaged")
                start = Select(Compare("eq", Get("i64", fields.cell.place(span.offset + 8)), index(0)), used, known)
            starts[path] = writer.let("first", start)
    return starts


def mark(message: Message, path: Path) -> None:
    """The field is there: its presence bit, or the case of its union."""
    fields, row = message.fields, row_of(message.fields)
    member = row.member(path[0])
    if member.presence is not None:
        word = message.presence[member.presence // 64]
        message.writer.assign(word, Binary("or", word, Const("u64", 1 << member.presence % 64)))
    if isinstance(member.slot, Variant) and len(path) > 1:
        number = next(n for n, case in enumerate(member.slot.members, 1) if case.name == path[1])
        message.writer.emit(SetField(fields.cell.place(member.slot.offset), index(number)))


def clear_other_case(message: Message, path: Path) -> None:
    """A message that becomes the case of a union starts empty; one that is the case already is merged into."""
    member = row_of(message.fields).member(path[0])
    if isinstance(member.slot, Variant) and len(path) > 1:
        number = next(n for n, case in enumerate(member.slot.members, 1) if case.name == path[1])
        slot = member.slot.members[number - 1].slot
        other = Compare("ne", Get("i64", message.fields.cell.place(member.slot.offset)), index(number))
        empty = Fill(message.fields.cell.place(slot.offset), index(slot_end(slot) - slot.offset))
        message.writer.emit(If(other, (empty,)))


def slot_end(slot: Slot) -> int:
    """The offset behind a slot."""
    match slot:
        case NumberSlot(offset, scalar):
            return offset + WIDTH[scalar]
        case Span(offset, _):
            return offset + 16
        case Row(offset, _, _, members):
            return max([offset + slot.head_bytes, *(slot_end(member.slot) for member in members)])
        case Variant(offset, members):
            return max([offset + 8, *(slot_end(member.slot) for member in members)])


def set_number(fields: HolderFields, path: Path, value: Local) -> None:
    """Set a field that is a number."""
    cell = fields.find(path)
    assert isinstance(cell.slot, NumberSlot)
    fields.writer.emit(SetField(cell.place(cell.slot.offset), converted(value, cell.slot.scalar)))


def row_of(fields: HolderFields) -> Row:
    """The row that is filled."""
    assert isinstance(fields.cell.slot, Row)
    return fields.cell.slot


def lane_of(fields: HolderFields, path: Path) -> int:
    """The lane of an array's elements."""
    return span_of(fields.find(path)).lane
