"""Arrays of protobuf whose numbers have no tags of their own: those of a fixed size, and runs of short varints."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.codec.fields import converted, scalar_name
from rosetta_jit.lowering.codec.holder_fields import HolderFields
from rosetta_jit.lowering.codec.varint import SEVEN_BITS, ends_within, from_varint, read_short
from rosetta_jit.lowering.writer import Where, Writer, block
from rosetta_jit.model.layout import Number as NumberSlot
from rosetta_jit.wire.codec import Entry, Tagged, Varint

WORD = 8
"""Bytes that are looked at together."""
CONTINUES = int.from_bytes(b"\x80" * WORD, "little")
"""The bits of a word that say of each of its bytes that its varint goes on behind it."""
TWOS = int.from_bytes(b"\x80\x00" * (WORD // 2), "little")
"""Those of them that are set where all varints in a word take two bytes."""
CROWDED = 16
"""Arrays of varints in a message beyond which each of their varints is read by itself: code for several takes 6 ms an array to compile."""
SECOND = 0x7F << 7
"""The bits of a number that the second byte of its varint has."""


def read_fixed(writer: Writer, fields: HolderFields, lane: int, size: nodes.Local, scalar: str, order: str, where: Where) -> None:
    """Numbers of a fixed size, as many as fill ``size`` bytes."""
    width = nodes.WIDTH[scalar]
    count = writer.let("count", nodes.Binary("div", size, index(width)))
    whole = nodes.Compare("eq", nodes.Binary("rem", size, index(width)), index(0))
    writer.expect(whole, "length", where, f"not a multiple of {width} bytes")
    start = fields.reserve(lane, count)
    number = nodes.Local("i64", writer.fresh("i"))
    first = writer.position
    with writer.nested() as body:
        writer.position = writer.let("item", nodes.Binary("add", first, mul(number, width)))
        writer.require(width, where)
        value = nodes.Load(scalar_name(scalar), writer.position, ">" if order == ">" else "<")
        writer.emit(nodes.SetField(nodes.Place(lane, add(start, number)), converted(value, _element(fields, lane).scalar)))
    writer.emit(nodes.For(number.name, count, block(body)))
    writer.advance(size)


def reads_several(entry: Entry, tagged: Tagged) -> bool:
    """Whether varints of an array are read several at once: not where each is looked at by itself, as the numbers of closed enums are."""
    arrays = sum(each.label != "single" and isinstance(each.value, Varint) for each in tagged.entries)
    return not entry.allowed and arrays <= CROWDED


def read_varints(
    writer: Writer, fields: HolderFields, varint: Varint, lane: int, stop: nodes.Expr, at: nodes.Local, read_one: Callable[[], None]
) -> None:
    """One round of a loop over varints up to ``stop``: several of a word if none takes more than two bytes, or one of any size.

    ``at`` is the place of the next varint, and afterwards that behind what was read. Which of several take two bytes is computed: where it
    changes from one to the next, a processor would guess it wrongly. Where all are alike, LLVM makes vectors of them.
    """
    scalar = _element(fields, lane).scalar
    word = writer.var("word", nodes.Const("u64", (1 << 64) - 1))
    with writer.nested() as enough:
        writer.assign(word, nodes.Load("u64", at, "<"))
    writer.emit(nodes.If(nodes.Compare("ge", nodes.Binary("sub", stop, at), index(WORD)), block(enough)))
    bits = writer.let("goes_on", _and(word, CONTINUES))
    longer = nodes.Binary("and", bits, nodes.Binary("shl", bits, nodes.Const("u64", 8)))
    with writer.nested() as ones:
        append_varints(writer, varint, lane, scalar, [_and(_behind(word, number), 0xFF) for number in range(WORD)])
        writer.assign(at, add(at, WORD))
    with writer.nested() as twos:
        append_varints(writer, varint, lane, scalar, [of_two(_behind(word, 2 * number)) for number in range(WORD // 2)])
        writer.assign(at, add(at, WORD))
    with writer.nested() as mixed:
        _append_mixed(writer, varint, lane, scalar, word, at)
    with writer.nested() as short:
        alike = nodes.If(nodes.Compare("eq", bits, nodes.Const("u64", TWOS)), block(twos), block(mixed))
        writer.emit(nodes.If(nodes.Compare("eq", bits, nodes.Const("u64", 0)), block(ones), (alike,)))
    with writer.nested() as one:
        value, after = read_short(writer, at, word)
        append_varints(writer, varint, lane, scalar, [value])
        writer.assign(at, after)
    with writer.nested() as other:
        read_one()
    long = nodes.If(ends_within(word), block(one), block(other))
    writer.emit(nodes.If(nodes.Compare("eq", longer, nodes.Const("u64", 0)), block(short), (long,)))


def _append_mixed(writer: Writer, varint: Varint, lane: int, scalar: str, word: nodes.Local, at: nodes.Local) -> None:
    """The first four numbers of a word: each takes two bytes if its first one says so."""
    rest, after = word, add(at, WORD // 2)
    values: list[nodes.Expr] = []
    for _ in range(WORD // 2):
        more = writer.let("more", _and(nodes.Binary("shr", rest, nodes.Const("u64", 7)), 1))
        second = nodes.Binary(
            "and", nodes.Binary("shr", rest, nodes.Const("u64", 1)), nodes.Binary("mul", more, nodes.Const("u64", SECOND))
        )
        values.append(writer.let("varint", nodes.Binary("or", nodes.Binary("and", rest, SEVEN_BITS), second)))
        bits = nodes.Binary("add", nodes.Binary("shl", more, nodes.Const("u64", 3)), nodes.Const("u64", 8))
        rest = writer.let("rest", nodes.Binary("shr", rest, bits))
        after = nodes.Binary("add", after, nodes.Convert("i64", more))
    behind = writer.let("behind", after)
    append_varints(writer, varint, lane, scalar, values)
    writer.assign(at, behind)


def append_varints(writer: Writer, varint: Varint, lane: int, scalar: str, values: list[nodes.Expr]) -> None:
    """Put the numbers that varints stand for at the end of a lane."""
    writer.emit(nodes.Reserve(lane, index(len(values))))
    for number, value in enumerate(values):
        whole = from_varint(varint, writer.let("varint", value), scalar)
        writer.emit(nodes.SetField(nodes.Place(lane, add(nodes.Used(lane), number)), converted(whole, scalar)))
    writer.emit(nodes.Advance(lane, index(len(values))))


def _behind(word: nodes.Local, size: int) -> nodes.Expr:
    """A word without its first bytes."""
    return nodes.Binary("shr", word, nodes.Const("u64", 8 * size)) if size else word


def of_two(word: nodes.Expr) -> nodes.Expr:
    """The varint that the first two bytes of a word are."""
    return nodes.Binary("or", nodes.Binary("and", word, SEVEN_BITS), _and(nodes.Binary("shr", word, nodes.Const("u64", 1)), SECOND))


def _and(value: nodes.Expr, bits: int) -> nodes.Expr:
    return nodes.Binary("and", value, nodes.Const("u64", bits))


def _element(fields: HolderFields, lane: int) -> NumberSlot:
    element = fields.layout.lanes[lane].element
    assert isinstance(element, NumberSlot)
    return element
