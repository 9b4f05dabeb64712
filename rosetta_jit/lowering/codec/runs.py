"""Runs of numbers in protobuf: elements of one array, each behind the same tag of one byte.

    element tag element tag element …

A loop that reads any field in any order takes some twenty instructions an element. Here a round takes seven: it asks whether the same tag
comes again, and nothing else. The loop ends at another tag, where the lane has no more room, and before the last element that may fit into
the message; what follows is read like any field. Varints of up to five bytes are read so, too: one with its tag, or four of one byte, of
eight bytes that are looked at together.
"""

from __future__ import annotations

from rosetta_jit.kernel.nodes import (
    WIDTH,
    Advance,
    Binary,
    Capacity,
    Compare,
    Const,
    Convert,
    Expr,
    If,
    Load,
    Local,
    Place,
    SetField,
    Used,
    While,
)
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.codec.fields import converted, scalar_name
from rosetta_jit.lowering.codec.holder_fields import HolderFields
from rosetta_jit.lowering.codec.packed import WORD, append_varints, of_two
from rosetta_jit.lowering.codec.varint import SEVEN_BITS, ends_within, read_short
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.model.layout import Number as NumberSlot
from rosetta_jit.wire.codec import Entry, Number, Tagged, Varint

CROWDED = 4
"""Arrays of such numbers in a message beyond which none is read in runs: each loop takes time to compile."""
ONE_BYTE_TAGS = 1 << 7
"""Tags below this take one byte."""
ALTERNATE = 0x0001_0001_0001_0001
"""Times a tag and a byte: a word that has them four times."""
PAIR = 0x000001_000001
"""Times a tag and two bytes: a word that has them twice."""


def has_runs(entry: Entry, tagged: Tagged) -> bool:
    """Whether elements of an array are read in runs."""
    arrays = sum(each.label != "single" and isinstance(each.value, Number) for each in tagged.entries)
    return entry.number << 3 < ONE_BYTE_TAGS and arrays <= CROWDED


def has_runs_of_varints(entry: Entry, tagged: Tagged) -> bool:
    """The same of varints: not where each is looked at by itself, as numbers of closed enums are, nor where they come packed as a rule."""
    arrays = sum(each.label == "repeated" and isinstance(each.value, Varint) for each in tagged.entries)
    return entry.label == "repeated" and not entry.allowed and entry.number << 3 < ONE_BYTE_TAGS and arrays <= CROWDED


def read_run(writer: Writer, fields: HolderFields, lane: int, number: Number, tag: int, stop: Expr) -> None:
    """Append further numbers as long as they come behind the tag, and there is room for them."""
    slot = fields.layout.lanes[lane].element
    assert isinstance(slot, NumberSlot)
    width = WIDTH[scalar_name(number.scalar)]
    start, step = writer.position, width + 1
    after = writer.var("next", start)
    with writer.nested() as inside:
        fitting = Binary("div", Binary("sub", Binary("sub", stop, start), index(1)), index(step))
        room = Binary("sub", Capacity(lane), Used(lane))
        most = writer.let("most", Binary("min", fitting, room))
        run = writer.var("run", index(0))
        here = add(start, mul(run, step))
        with writer.nested() as body:
            value = Load(scalar_name(number.scalar), add(here, 1), ">" if number.order == ">" else "<")
            writer.emit(SetField(Place(lane, add(Used(lane), run)), converted(value, slot.scalar)))
            writer.assign(run, add(run, 1))
        again = Compare("eq", Convert("i64", Load("u8", here)), index(tag))
        invariant = (Compare("ge", run, index(0)), Compare("le", run, most))
        writer.emit(While(Binary("and", Compare("lt", run, most), again), block(body), invariant, run))
        writer.emit(Advance(lane, run))
        writer.assign(after, add(start, mul(run, step)))
    writer.emit(If(Compare("lt", start, stop), block(inside)))
    writer.position = after


def read_run_of_varints(writer: Writer, fields: HolderFields, lane: int, varint: Varint, tag: int, begin: Expr, stop: Expr) -> None:
    """The same of varints, as long as there are eight bytes to look at; ``begin`` is where the first one began."""
    slot = fields.layout.lanes[lane].element
    assert isinstance(slot, NumberSlot)
    at, word = writer.var("at", writer.position), writer.var("word", Const("u64", 0))
    enough = Compare("ge", Binary("sub", stop, at), index(WORD))
    behind_tag = _behind(word, 8)

    def look() -> None:
        with writer.nested() as there:
            writer.assign(word, Load("u64", at, "<"))
        writer.emit(If(enough, block(there)))

    look()
    with writer.nested() as four:
        values: list[Expr] = [Binary("and", _behind(word, bits), SEVEN_BITS) for bits in (8, 24, 40, 56)]
        append_varints(writer, varint, lane, slot.scalar, values)
        writer.assign(at, add(at, WORD))
    with writer.nested() as two:
        append_varints(writer, varint, lane, slot.scalar, [of_two(_behind(word, bits)) for bits in (8, 32)])
        writer.assign(at, add(at, 6))
    with writer.nested() as one:
        value, after = read_short(writer, writer.let("number", add(at, 1)), writer.let("rest", behind_tag))
        append_varints(writer, varint, lane, slot.scalar, [value])
        writer.assign(at, after)
    with writer.nested() as body:
        longer = If(_is_of(word, PAIR * 0x80_80_FF, PAIR * (0x80_00 | tag)), block(two), block(one))
        writer.emit(If(_is_of(word, ALTERNATE * 0x80_FF, ALTERNATE * tag), block(four), (longer,)))
        look()
    again = Binary("and", Binary("and", enough, _is_of(word, 0xFF, tag)), ends_within(behind_tag))
    writer.emit(While(again, block(body), writer.behind(begin, at), at))
    writer.position = at


def _behind(word: Local, bits: int) -> Expr:
    return Binary("shr", word, Const("u64", bits))


def _is_of(word: Local, mask: int, bits: int) -> Expr:
    """Whether the bits of a mask are these in a word."""
    return Compare("eq", Binary("and", word, Const("u64", mask)), Const("u64", bits))
