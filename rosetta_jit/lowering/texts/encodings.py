"""Bytes as text and text as bytes: ASCII, Latin-1, and UTF-16 of either byte order (RFC 3629, RFC 2781)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Expr, If, Local, Select
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.texts.views import TRUE, View, has_room, kept, parameters, put, room, scanning
from rosetta_jit.lowering.writer import MESSAGE, Contract, Writer, block
from rosetta_jit.startup.dataclass import dataclass

LEAD, TRAIL, BEYOND, PLANE = 0xD800, 0xDC00, 0xE000, 0x10000
"""The first surrogates of a pair, the first unit behind them, and the first character that takes a pair."""

CHARACTER = 0x1FFFFF
"""Bits of a character."""

GROWTH = 4
"""Bytes written for each that is read, at most, as far as the proof looks."""


@dataclass(frozen=True, slots=True)
class Recoded:
    """A text in other bytes, and whether it could be."""

    view: View
    good: Expr


@dataclass(frozen=True, slots=True)
class _Step:
    """One byte of a text that is written anew: where to, whether all was good so far, and what is remembered of the bytes before."""

    writer: Writer
    byte: Local
    to: Local
    good: Local
    state: tuple[Local, ...]

    def refuse(self) -> None:
        self.writer.assign(self.good, index(0))

    def put(self, byte: Expr) -> None:
        put(self.writer, self.to, Convert("u8", byte))
        self.writer.assign(self.to, add(self.to, 1))


def is_ascii(writer: Writer, view: View) -> Expr:
    """Whether a text is ASCII."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        good = inner.var("good", index(1))
        with scanning(inner, view.lane, first, after) as scan:
            with inner.nested() as other:
                inner.assign(good, index(0))
                inner.assign(scan.done, TRUE)
            inner.emit(If(Compare("ge", scan.byte, Const("u8", 128)), block(other)))
        return Contract((first, after), (good,), known, ())

    (good,) = writer.call(f"is_ascii_{view.memory}", make, (view.first, view.after), MESSAGE)
    return Compare("eq", good, index(1))


def from_latin(writer: Writer, view: View) -> Recoded:
    """Latin-1 as UTF-8."""
    return _recoded(writer, view, "from_latin", lambda step: _put_utf8(step, step.byte))


def from_utf16(writer: Writer, view: View, *, big: bool) -> Recoded:
    """UTF-16 as UTF-8."""
    name = f"from_utf16{'be' if big else 'le'}"
    return _recoded(writer, view, name, partial(_take_byte, big=big), ("before", "odd", "lead"))


def to_latin(writer: Writer, view: View) -> Recoded:
    """UTF-8 as Latin-1."""
    return _recoded(writer, view, "to_latin", partial(_take_utf8, write=_put_latin), ("character", "left"))


def to_utf16(writer: Writer, view: View, *, big: bool) -> Recoded:
    """UTF-8 as UTF-16."""
    name = f"to_utf16{'be' if big else 'le'}"
    return _recoded(writer, view, name, partial(_take_utf8, write=partial(_put_utf16, big=big)), ("character", "left"))


def _recoded(writer: Writer, view: View, name: str, take: Callable[[_Step], None], state: tuple[str, ...] = ()) -> Recoded:
    """Write a text anew, byte by byte. What is remembered begins as 0; all but the first must be 0 again at the end."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        target = inner.parameter("target", "i64")
        to, good = inner.var("to", target), inner.var("good", index(1))
        remembered = tuple(inner.var(each, index(0)) for each in state)

        def bounds(at: Expr) -> tuple[Expr, ...]:
            return Compare("ge", to, target), Compare("le", to, Binary("add", target, mul(Binary("sub", at, first), GROWTH)))

        with scanning(inner, view.lane, first, after, bounds) as scan:
            take(_Step(inner, inner.let("number", Convert("i64", scan.byte)), to, good, remembered))
        finished = good
        for each in remembered[1:]:
            finished = Select(Compare("eq", each, index(0)), finished, index(0))
        room_needed = has_room(inner, target, mul(Binary("sub", after, first), GROWTH))
        return Contract((first, after, target), (to, inner.let("finished", finished)), (*known, *room_needed), bounds(after))

    start = room(writer, mul(writer.let("size", view.size), GROWTH))
    after, good = writer.call(f"{name}_{view.memory}", make, (view.first, view.after, start), MESSAGE)
    return Recoded(kept(writer, start, start, after, valid=name.startswith("from")), Compare("eq", good, index(1)))


def _take_byte(step: _Step, *, big: bool) -> None:
    """Every second byte completes a unit."""
    writer, (before, odd, lead) = step.writer, step.state
    high, low = (before, step.byte) if big else (step.byte, before)
    unit = writer.let("unit", Binary("or", Binary("shl", high, index(8)), low))
    with writer.nested() as whole:
        _take_unit(step, unit, lead)
    writer.emit(If(Compare("eq", odd, index(1)), block(whole)))
    writer.assign(before, step.byte)
    writer.assign(odd, Binary("xor", odd, index(1)))


def _take_unit(step: _Step, unit: Local, lead: Local) -> None:
    """A character, or a surrogate of one: a leading one waits for a trailing one, and that must have been waited for."""
    writer = step.writer
    is_lead, is_trail = (_is_within(unit, first, after) for first, after in ((LEAD, TRAIL), (TRAIL, BEYOND)))
    pair = Binary("or", Binary("shl", Binary("and", lead, index(0x3FF)), index(10)), Binary("and", unit, index(0x3FF)))
    character = writer.let(
        "character", Select(is_trail, add(Binary("and", pair, index(0xFFFFF)), PLANE), Binary("and", unit, index(0xFFFF)))
    )
    waited = Compare("ne", lead, index(0))
    bad = writer.let("bad", Binary("xor", waited, is_trail))
    with writer.nested() as refused:
        step.refuse()
    with writer.nested() as kept_back:
        writer.assign(lead, unit)
    with writer.nested() as complete:
        _put_utf8(step, character)
        writer.assign(lead, index(0))
    writer.emit(If(bad, block(refused), (If(is_lead, block(kept_back), block(complete)),)))


def _is_within(value: Expr, first: int, after: int) -> Expr:
    return Binary("and", Compare("ge", value, index(first)), Compare("lt", value, index(after)))


def _put_utf8(step: _Step, character: Expr) -> None:
    """RFC 3629, 3. All four bytes are written, and as many count as the character takes."""
    writer = step.writer
    value = writer.let("value", Binary("and", character, index(CHARACTER)))
    sizes = [Compare("lt", value, index(limit)) for limit in (0x80, 0x800, PLANE)]

    def by_size(*ways: Expr) -> Expr:
        *shorter, chosen = ways
        for condition, way in zip(reversed(sizes[-len(shorter) :]), reversed(shorter), strict=True):
            chosen = Select(condition, way, chosen)
        return chosen

    def tail(shift: int) -> Expr:
        return Binary("or", Binary("and", Binary("shr", value, index(shift)), index(0x3F)), index(0x80))

    def lead(shift: int, mark: int) -> Expr:
        return Binary("or", Binary("shr", value, index(shift)), index(mark))

    first = by_size(value, lead(6, 0xC0), lead(12, 0xE0), lead(18, 0xF0))
    for place, byte in enumerate((first, by_size(tail(0), tail(6), tail(12)), by_size(tail(0), tail(6)), tail(0))):
        put(writer, add(step.to, place), Convert("u8", byte))
    writer.assign(step.to, Binary("add", step.to, by_size(index(1), index(2), index(3), index(4))))


def _take_utf8(step: _Step, *, write: Callable[[_Step, Local], None]) -> None:
    """A first byte says how many follow; behind the last of them the character is written. The text is known to be UTF-8."""
    writer, byte, (character, left) = step.writer, step.byte, step.state
    follows = _is_within(byte, 0x80, 0xC0)
    more = Binary("or", Binary("shl", character, index(6)), Binary("and", byte, index(0x3F)))
    begun: Expr = Binary("and", byte, index(0x07))
    count: Expr = index(3)
    for limit, mask, following in ((0xF0, 0x0F, 2), (0xE0, 0x1F, 1), (0x80, 0x7F, 0)):
        begun = Select(Compare("lt", byte, index(limit)), Binary("and", byte, index(mask)), begun)
        count = Select(Compare("lt", byte, index(limit)), index(following), count)
    writer.assign(character, Binary("and", Select(follows, more, begun), index(CHARACTER)))
    writer.assign(left, Select(follows, add(Binary("max", left, index(1)), -1), count))
    with writer.nested() as whole:
        write(step, character)
    writer.emit(If(Compare("eq", left, index(0)), block(whole)))


def _put_latin(step: _Step, character: Local) -> None:
    step.put(character)
    with step.writer.nested() as other:
        step.refuse()
    step.writer.emit(If(Compare("ge", character, index(0x100)), block(other)))


def _put_utf16(step: _Step, character: Local, *, big: bool) -> None:
    """RFC 2781, 2.1."""
    writer = step.writer
    is_pair = Compare("ge", character, index(PLANE))
    above = Binary("and", Binary("sub", Binary("and", character, index(CHARACTER)), index(PLANE)), index(0xFFFFF))
    lead = Binary("or", Binary("shr", above, index(10)), index(LEAD))
    _put_unit(step, Select(is_pair, lead, character), big=big)
    with writer.nested() as pair:
        _put_unit(step, Binary("or", Binary("and", above, index(0x3FF)), index(TRAIL)), big=big)
    writer.emit(If(is_pair, block(pair)))


def _put_unit(step: _Step, unit: Expr, *, big: bool) -> None:
    value = step.writer.let("unit", unit)
    high = Binary("shr", value, index(8))
    for byte in (high, value) if big else (value, high):
        step.put(byte)
