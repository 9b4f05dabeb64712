"""Routines that look into texts, and comparisons of texts: what they find are places, so that nothing is copied."""

from __future__ import annotations

from typing import Literal

from rosetta_jit.kernel.nodes import WIDTH, Address, Binary, Compare, Const, Expr, Get, If, Load, Local, Place, Scalar, Select, While, Wire
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.language import typed
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.views import TRUE, View, between, byte_at, is_one_of, parameters, scanning, sound, within
from rosetta_jit.lowering.writer import MESSAGE, Contract, Writer, block


def compared(writer: Writer, left: View, right: View) -> Expr:
    """Below 0, 0 or above as one text comes before the other, byte by byte."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, left.lane)
        other, other_after, also_known = parameters(inner, right.lane, ("other", "other_after"))
        sizes = Binary("sub", after, first), Binary("sub", other_after, other)
        length = inner.let("length", Binary("min", *sizes))
        result = inner.var("order", index(0))
        with scanning(inner, left.lane, first, Binary("add", first, length)) as scan:
            beside = inner.let("beside", byte_at(right.lane, Binary("add", other, Binary("sub", scan.at, first))))
            with inner.nested() as different:
                inner.assign(result, Select(Compare("lt", scan.byte, beside), index(-1), index(1)))
                inner.assign(scan.done, TRUE)
            inner.emit(If(Compare("ne", scan.byte, beside), block(different)))
        decided = Compare("ne", result, index(0))
        order = inner.let("found", Select(decided, result, Binary("sub", *sizes)))
        return Contract((first, after, other, other_after), (order,), (*known, *also_known), ())

    (order,) = writer.call(f"compare_{left.memory}_{right.memory}", make, (left.first, left.after, right.first, right.after), MESSAGE)
    return order


def has_at(writer: Writer, end: Literal["starts_with", "ends_with"], view: View, other: View) -> Local:
    """Whether one text is the begin or the end of another."""
    found = writer.var("found", Const("bool", value=False))
    size = writer.let("size", other.size)
    with writer.nested() as long_enough:
        if end == "starts_with":
            part_of_it = View(view.lane, view.first, Binary("add", view.first, size))
        else:
            part_of_it = View(view.lane, Binary("sub", view.after, size), view.after)
        writer.assign(found, Compare("eq", compared(writer, sound(writer, part_of_it), other), index(0)))
    writer.emit(If(Compare("le", size, view.size), block(long_enough)))
    return found


MOST_PARTS = index(1 << 62)
"""More parts than any text has."""


def find(writer: Writer, lane: int | None, first: Expr, after: Expr, pattern: bytes) -> Local:
    """The first position of a text, or the end."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, lane)
        found = inner.var("found", after)
        with inner.nested() as long_enough, scanning(inner, lane, first, add(after, 1 - len(pattern))) as scan:
            same = is_one_of(scan.byte, pattern[:1])
            with inner.nested() as candidate:
                _rest(inner, lane, scan.at, pattern, found, scan.done)
            inner.emit(If(same, block(candidate)))
        inner.emit(If(Compare("ge", Binary("sub", after, first), index(len(pattern))), block(long_enough)))
        place = inner.let("place", between(found, first, after))
        return Contract((first, after), (place,), known, within(first, place, after=after))

    memory = View(lane, first, after).memory
    (place,) = writer.call(f"find_{memory}_{pattern.hex()}", make, (first, after), MESSAGE)
    return place


def _rest(writer: Writer, lane: int | None, at: Local, pattern: bytes, found: Local, done: Local) -> None:
    """The first byte is there: are the others?"""
    with writer.nested() as here:
        writer.assign(found, at)
        writer.assign(done, TRUE)
    same: Expr = TRUE
    for number, byte in enumerate(pattern[1:], 1):
        same = Binary("and", same, is_one_of(byte_at(lane, add(at, number)), bytes([byte])))
    writer.emit(If(same, block(here)))


def stripped(writer: Writer, view: View, characters: bytes) -> View:
    """A text without some characters at its ends."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        start, stop = inner.var("start", after), inner.var("stop", first)
        with scanning(inner, view.lane, first, after) as scan:
            with inner.nested() as keep:
                inner.assign(start, Binary("min", start, scan.at))
                inner.assign(stop, add(scan.at, 1))
            inner.emit(If(is_one_of(scan.byte, characters), (), block(keep)))
        begin = inner.let("begin_kept", between(start, first, after))
        end = inner.let("end_kept", between(stop, begin, after))
        return Contract((first, after), (begin, end), known, within(first, begin, end, after=after))

    first, after = writer.call(f"strip_{view.memory}_{characters.hex()}", make, (view.first, view.after), MESSAGE)
    return sound(writer, View(view.lane, first, after, view.valid))


def next_start(writer: Writer, found: Expr, after: Expr, pattern: bytes) -> Expr:
    """The position at which to search on; one beyond the end where nothing was found."""
    behind = Binary("min", add(found, len(pattern)), after)
    return writer.let("behind", Select(Compare("lt", found, after), behind, add(after, 1)))


def part(writer: Writer, view: View, pattern: bytes, number: Expr) -> tuple[View, Expr]:
    """The part of that number, from 0, of a text that a pattern divides, and whether there is one."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        wanted = inner.parameter("wanted", "i64")
        start, passed = inner.var("start", first), inner.var("passed", index(0))
        with inner.nested() as body:
            inner.assign(start, next_start(inner, find(inner, view.lane, start, after, pattern), after, pattern))
            inner.assign(passed, add(passed, 1))
        more = Binary("and", Compare("le", start, after), Compare("lt", passed, wanted))
        limits = Compare("ge", start, first), Compare("le", start, add(after, 1)), Compare("ge", passed, index(0))
        inner.emit(While(more, block(body), limits, start))
        exists = Binary("and", Compare("ge", wanted, index(0)), Compare("le", start, after))
        there = inner.let("there", Select(exists, index(1), index(0)))
        begin = inner.let("begin_part", Binary("min", start, after))
        end = find(inner, view.lane, begin, after, pattern)
        return Contract((first, after, wanted), (begin, end, there), known, within(first, begin, end, after=after))

    name = f"part_{view.memory}_{pattern.hex()}"
    first, after, there = writer.call(name, make, (view.first, view.after, number), MESSAGE)
    return sound(writer, View(view.lane, first, after, view.valid)), Compare("eq", there, index(1))


def parts(writer: Writer, view: View, pattern: bytes) -> Local:
    """In how many parts a pattern divides a text: 1 where it is not met with."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        start, count = inner.var("start", first), inner.var("count", index(0))
        with inner.nested() as body:
            inner.assign(start, next_start(inner, find(inner, view.lane, start, after, pattern), after, pattern))
            inner.assign(count, add(count, 1))
        seen = Binary("sub", start, first)
        limits = (
            Compare("ge", start, first),
            Compare("le", start, add(after, 1)),
            Compare("ge", count, index(0)),
            Compare("le", count, seen),
        )
        inner.emit(While(Compare("le", start, after), block(body), limits, start))
        return Contract((first, after), (count,), known, ())

    (count,) = writer.call(f"parts_{view.memory}_{pattern.hex()}", make, (view.first, view.after), MESSAGE)
    return writer.let("parts", between(count, index(0), MOST_PARTS))  # the proof follows this as a number of an element, and no contract


WORDS: tuple[Scalar, ...] = ("u64", "u32", "u16", "u8")
"""What the bytes of a message are compared in."""


def is_text(values: Evaluation, place: typed.Place, text: bytes) -> Expr:
    """Whether a field holds these bytes."""
    return are_bytes(values, values.source.count(place, values), values.source.address(place, values), text)


def are_bytes(values: Evaluation, count: Expr, address: Address, text: bytes) -> Expr:
    """Whether so many bytes at an address are these. They are looked at only where there are as many."""
    writer = values.writer
    if not text:
        return Compare("eq", count, index(0))
    found = writer.var("is_text", Const("bool", value=False))
    with writer.nested() as inside:
        if isinstance(address, Wire):  # a field that several forms of a message have is not known to be where each of them has it
            writer.require(len(text), values.where, at=address.at)
        writer.assign(found, Const("bool", value=True))
        for offset, piece in _pieces(text, isinstance(address, Place)):
            same = Compare("eq", _word(address, offset, piece), piece)
            writer.assign(found, Binary("and", found, same))
    writer.emit(If(Compare("eq", count, index(len(text))), block(inside)))
    return found


def _pieces(text: bytes, in_lane: bool) -> list[tuple[int, Const]]:
    """A text as integers; rows of a lane are bytes, and read one by one."""
    pieces: list[tuple[int, Const]] = []
    offset = 0
    while offset < len(text):
        left = 1 if in_lane else len(text) - offset
        word: Scalar = next(word for word in WORDS if WIDTH[word] <= left)
        pieces.append((offset, Const(word, int.from_bytes(text[offset : offset + WIDTH[word]], "little"))))
        offset += WIDTH[word]
    return pieces


def _word(address: Address, offset: int, piece: Const) -> Expr:
    if isinstance(address, Place):
        return Get(piece.type, Place(address.lane, add(address.row, offset)))
    return Load(piece.type, add(address.at, offset))
