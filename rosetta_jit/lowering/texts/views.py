"""Texts while rules run: bytes of the message or of a lane, looked at where they lie; new ones are written to a hidden lane."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager

from rosetta_jit.kernel import ir
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.writer import MESSAGE, Writer, block
from rosetta_jit.startup.dataclass import dataclass

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
    first: ir.Expr
    after: ir.Expr
    valid: bool = False

    @property
    def size(self) -> ir.Expr:
        return ir.Binary("sub", self.after, self.first)

    @property
    def address(self) -> ir.Address:
        return ir.Wire(self.first) if self.lane is None else ir.Place(self.lane, self.first)

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


def byte_at(lane: int | None, at: ir.Expr) -> ir.Expr:
    """One byte of a lane of bytes, or of the message."""
    return ir.Load("u8", at) if lane is None else ir.Get("u8", ir.Place(lane, at))


def lies_in(lane: int | None, at: ir.Expr) -> ir.Expr:
    """Whether there is such a byte."""
    low, high = (BEGIN, END) if lane is None else (index(0), ir.Capacity(lane))
    return ir.Binary("and", ir.Compare("ge", at, low), ir.Compare("lt", at, high))


def put(writer: Writer, at: ir.Expr, byte: ir.Expr | int) -> None:
    """Write a byte of the hidden lane."""
    writer.emit(ir.SetField(ir.Place(lane_of(writer), at), ir.Const("u8", byte) if isinstance(byte, int) else byte))


def room(writer: Writer, size: ir.Expr) -> ir.Local:
    """Where the next so many bytes of the hidden lane begin; they become part of it by `kept`."""
    writer.emit(ir.Reserve(lane_of(writer), size))
    start = writer.let("text", ir.Used(lane_of(writer)))
    for each in has_room(writer, start, size):  # there is: said again, as what is used becomes a long sum where many texts are made
        writer.expect(each, "length", MESSAGE, LOST)
    return start


def kept(writer: Writer, start: ir.Expr, first: ir.Expr, after: ir.Expr, *, valid: bool) -> View:
    """The view of what was written from ``first`` to ``after``, into the room that starts there or before."""
    lane, end = lane_of(writer), writer.let("after", after)
    count = writer.let("written", ir.Binary("sub", end, start))
    writer.emit(ir.Reserve(lane, count), ir.Advance(lane, count))  # there is room: said again where the proof may have lost it
    return sound(writer, View(lane, first, end, valid))


def sound(writer: Writer, view: View, expect: Callable[[ir.Expr], None] | None = None) -> View:
    """A view that lies where it says. That follows from how it was made; written down, each use of it is proven at a glance.

    Where it follows from a check before, ``expect`` is that check: in a loop, this one may be made before it.
    """
    known = [ir.Compare("le", view.first, view.after)]
    if view.lane is None:
        known += [ir.Compare("ge", view.first, BEGIN), ir.Compare("le", view.after, END)]
    else:
        known += [ir.Compare("ge", view.first, index(0)), ir.Compare("le", view.after, ir.Capacity(view.lane))]
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
        writer.emit(ir.Advance(lane, index(len(text.text))))
        return
    size = writer.let("size", text.size)
    start = room(writer, size)
    if text.lane == lane:
        writer.expect(ir.Compare("le", text.after, start), "length", MESSAGE, LOST)
    writer.emit(ir.Copy(ir.Place(lane, start), text.address, size), ir.Advance(lane, size))


def joined(writer: Writer, texts: Iterable[Text]) -> View:
    """One text of several."""
    pieces = tuple(texts)
    start = writer.let("text", ir.Used(lane_of(writer)))
    for piece in pieces:
        append(writer, piece)
    valid = all(isinstance(piece, Quoted) or piece.valid for piece in pieces)
    return sound(writer, View(lane_of(writer), start, writer.let("after", ir.Used(lane_of(writer))), valid))


def placed(writer: Writer, text: Text) -> View:
    """A text that lies somewhere."""
    return joined(writer, (text,)) if isinstance(text, Quoted) else text


# --- within routines -----------------------------------------------------------------------------------------------------


def parameters(
    writer: Writer, lane: int | None, names: tuple[str, str] = ("first", "after")
) -> tuple[ir.Local, ir.Local, tuple[ir.Expr, ...]]:
    """The ends of a text that a routine is given, and what it relies on."""
    first, after = (writer.parameter(name, "i64") for name in names)
    low, high = (BEGIN, END) if lane is None else (index(0), ir.Capacity(lane))
    return first, after, (ir.Compare("ge", first, low), ir.Compare("le", first, after), ir.Compare("le", after, high))


def has_room(writer: Writer, target: ir.Expr, size: ir.Expr) -> tuple[ir.Expr, ir.Expr]:
    """The precondition of a routine that writes so many bytes to the hidden lane: there is room for them."""
    return ir.Compare("ge", target, index(0)), ir.Compare("le", target, ir.Binary("sub", ir.Capacity(lane_of(writer)), size))


def between(value: ir.Expr, low: ir.Expr, high: ir.Expr) -> ir.Expr:
    """A value that is known to lie there, so that the proof knows it too: that it is not too low at once."""
    return ir.Binary("max", ir.Binary("min", value, high), low)


def within(first: ir.Expr, *inside: ir.Expr, after: ir.Expr) -> tuple[ir.Expr, ...]:
    """A routine's promise: the places that it gives are in order, from one end of a text to the other."""
    places = (first, *inside, after)
    return tuple(ir.Compare("le", before, behind) for before, behind in itertools.pairwise(places))


@dataclass(frozen=True, slots=True)
class Scan:
    """A byte at a place; ``done`` is a variable that ends the scan."""

    at: ir.Local
    byte: ir.Local
    done: ir.Local


@contextmanager
def scanning(
    writer: Writer, lane: int | None, first: ir.Expr, after: ir.Expr, keeps: Callable[[ir.Local], tuple[ir.Expr, ...]] = lambda _: ()
) -> Generator[Scan]:
    """A block that looks at each byte of a text in turn; ``keeps`` says what holds at each place."""
    at, done = writer.var("at", first), writer.var("done", ir.Const("bool", value=False))
    with writer.nested() as body:
        yield Scan(at, writer.let("byte", byte_at(lane, at)), done)
        writer.assign(at, ir.Select(done, after, add(at, 1)))
    writer.emit(ir.While(ir.Compare("lt", at, after), block(body), (*within(first, at, after=after), *keeps(at)), at))


def is_one_of(byte: ir.Expr, characters: bytes) -> ir.Expr:
    """Whether a byte is among some, of which there is one at least."""
    found: ir.Expr = ir.Compare("eq", byte, ir.Const("u8", characters[0]))
    for character in characters[1:]:
        found = ir.Binary("or", found, ir.Compare("eq", byte, ir.Const("u8", character)))
    return found


def is_between(byte: ir.Expr, low: int, high: int) -> ir.Expr:
    """Whether a byte lies between two, both included."""
    return ir.Binary("and", ir.Compare("ge", byte, ir.Const("u8", low)), ir.Compare("le", byte, ir.Const("u8", high)))


TRUE = ir.Const("bool", value=True)
