"""Texts while rules run: bytes of the message or of a lane, looked at where they lie; new ones are written to a hidden lane."""

from __future__ import annotations

import itertools
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import (
    Advance,
    Binary,
    Capacity,
    Compare,
    Const,
    Copy,
    Get,
    Load,
    Place,
    Reserve,
    Select,
    SetField,
    Used,
    While,
    Wire,
)
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.writer import MESSAGE, block
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable

    from rosetta_jit.kernel.ir import Address, Expr, Local
    from rosetta_jit.lowering.writer import Writer

LANE = "texts"
"""The hidden lane of what is computed: one byte a row."""

LOST = "a text is not where it was put"
"""What no message brings about."""


@dataclass(frozen=True, slots=True)
class View:
    """Bytes from ``first`` to ``after``, exclusive: of a lane of bytes, or where that is None of the message.

    ``valid`` says that they are known to be UTF-8.
    """

    lane: int | None
    first: Expr
    after: Expr
    valid: bool = False

    @property
    def size(self) -> Expr:
        return Binary("sub", self.after, self.first)

    @property
    def address(self) -> Address:
        return Wire(self.first) if self.lane is None else Place(self.lane, self.first)

    @property
    def memory(self) -> str:
        """In the name of a routine that looks at it."""
        return "message" if self.lane is None else f"lane_{self.lane}"


@dataclass(frozen=True, slots=True)
class Quoted:
    """A text that the mapping writes down."""

    text: bytes


Text = View | Quoted


def lane_of(writer: Writer) -> int:
    """The hidden lane of computed texts."""
    return writer.lane(LANE, 1)


def byte_at(lane: int | None, at: Expr) -> Expr:
    """One byte of a lane of bytes, or of the message."""
    return Load("u8", at) if lane is None else Get("u8", Place(lane, at))


def lies_in(lane: int | None, at: Expr) -> Expr:
    """Whether there is such a byte."""
    low, high = (BEGIN, END) if lane is None else (index(0), Capacity(lane))
    return Binary("and", Compare("ge", at, low), Compare("lt", at, high))


def put(writer: Writer, at: Expr, byte: Expr | int) -> None:
    """Write a byte of the hidden lane."""
    writer.emit(SetField(Place(lane_of(writer), at), Const("u8", byte) if isinstance(byte, int) else byte))


def room(writer: Writer, size: Expr) -> Local:
    """Where the next so many bytes of the hidden lane begin; they become part of it by `kept`."""
    writer.emit(Reserve(lane_of(writer), size))
    start = writer.let("text", Used(lane_of(writer)))
    for each in has_room(writer, start, size):  # there is: said again, as what is used becomes a long sum where many texts are made
        writer.expect(each, "length", MESSAGE, LOST)
    return start


def kept(writer: Writer, start: Expr, first: Expr, after: Expr, *, valid: bool) -> View:
    """The view of what was written from ``first`` to ``after``, into the room that starts there or before."""
    lane, end = lane_of(writer), writer.let("after", after)
    count = writer.let("written", Binary("sub", end, start))
    writer.emit(Reserve(lane, count), Advance(lane, count))  # there is room: said again where the proof may have lost it
    return sound(writer, View(lane, first, end, valid))


def sound(writer: Writer, view: View, expect: Callable[[Expr], None] | None = None) -> View:
    """A view that lies where it says. That follows from how it was made; written down, each use of it is proven at a glance.

    Where it follows from a check before, ``expect`` is that check: in a loop, this one may be made before it.
    """
    known = [Compare("le", view.first, view.after)]
    if view.lane is None:
        known += [Compare("ge", view.first, BEGIN), Compare("le", view.after, END)]
    else:
        known += [Compare("ge", view.first, index(0)), Compare("le", view.after, Capacity(view.lane))]
    for each in known:
        if expect is None:
            writer.expect(each, "length", MESSAGE, LOST)
        else:
            expect(each)
    return view


def append(writer: Writer, text: Text) -> None:
    """Copy a text behind what the hidden lane holds."""
    lane = lane_of(writer)
    if isinstance(text, Quoted):
        start = room(writer, index(len(text.text)))
        for number, byte in enumerate(text.text):
            put(writer, add(start, number), byte)
        writer.emit(Advance(lane, index(len(text.text))))
        return
    size = writer.let("size", text.size)
    start = room(writer, size)
    if text.lane == lane:
        writer.expect(Compare("le", text.after, start), "length", MESSAGE, LOST)
    writer.emit(Copy(Place(lane, start), text.address, size), Advance(lane, size))


def joined(writer: Writer, texts: Iterable[Text]) -> View:
    """One text of several."""
    pieces = tuple(texts)
    start = writer.let("text", Used(lane_of(writer)))
    for piece in pieces:
        append(writer, piece)
    valid = all(isinstance(piece, Quoted) or piece.valid for piece in pieces)
    return sound(writer, View(lane_of(writer), start, writer.let("after", Used(lane_of(writer))), valid))


def placed(writer: Writer, text: Text) -> View:
    """A text that lies somewhere."""
    return joined(writer, (text,)) if isinstance(text, Quoted) else text


# --- within routines -----------------------------------------------------------------------------------------------------


def parameters(writer: Writer, lane: int | None, names: tuple[str, str] = ("first", "after")) -> tuple[Local, Local, tuple[Expr, ...]]:
    """The ends of a text that a routine is given, and what it relies on."""
    first, after = (writer.parameter(name, "i64") for name in names)
    low, high = (BEGIN, END) if lane is None else (index(0), Capacity(lane))
    return first, after, (Compare("ge", first, low), Compare("le", first, after), Compare("le", after, high))


def has_room(writer: Writer, target: Expr, size: Expr) -> tuple[Expr, Expr]:
    """What a routine relies on that writes so many bytes to the hidden lane."""
    return Compare("ge", target, index(0)), Compare("le", target, Binary("sub", Capacity(lane_of(writer)), size))


def between(value: Expr, low: Expr, high: Expr) -> Expr:
    """A value that is known to lie there, so that the proof knows it too: that it is not too low at once."""
    return Binary("max", Binary("min", value, high), low)


def within(first: Expr, *inside: Expr, after: Expr) -> tuple[Expr, ...]:
    """What a routine gives: places in order, from one end of a text to the other."""
    places = (first, *inside, after)
    return tuple(Compare("le", before, behind) for before, behind in itertools.pairwise(places))


@dataclass(frozen=True, slots=True)
class Scan:
    """A byte at a place; ``done`` is a variable that ends the scan."""

    at: Local
    byte: Local
    done: Local


@contextmanager
def scanning(
    writer: Writer, lane: int | None, first: Expr, after: Expr, keeps: Callable[[Local], tuple[Expr, ...]] = lambda _: ()
) -> Generator[Scan]:
    """A block that looks at each byte of a text in turn; ``keeps`` says what holds at each place."""
    at, done = writer.var("at", first), writer.var("done", Const("bool", value=False))
    with writer.nested() as body:
        yield Scan(at, writer.let("byte", byte_at(lane, at)), done)
        writer.assign(at, Select(done, after, add(at, 1)))
    writer.emit(While(Compare("lt", at, after), block(body), (*within(first, at, after=after), *keeps(at)), at))


def is_one_of(byte: Expr, characters: bytes) -> Expr:
    """Whether a byte is among some, of which there is one at least."""
    found: Expr = Compare("eq", byte, Const("u8", characters[0]))
    for character in characters[1:]:
        found = Binary("or", found, Compare("eq", byte, Const("u8", character)))
    return found


def is_between(byte: Expr, low: int, high: int) -> Expr:
    """Whether a byte lies between two, both included."""
    return Binary("and", Compare("ge", byte, Const("u8", low)), Compare("le", byte, Const("u8", high)))


TRUE = Const("bool", value=True)
