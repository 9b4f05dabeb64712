"""Texts while rules run: bytes of the message or of a lane, looked at where they lie; new ones are written to a hidden lane."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager

from rosetta_jit.kernel import nodes
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
    first: nodes.Expr
    after: nodes.Expr
    valid: bool = False

    @property
    def size(self) -> nodes.Expr:
        return nodes.Binary("sub", self.after, self.first)

    @property
    def address(self) -> nodes.Address:
        return nodes.Wire(self.first) if self.lane is None else nodes.Place(self.lane, self.first)

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


def byte_at(lane: int | None, at: nodes.Expr) -> nodes.Expr:
    """One byte of a lane of bytes, or of the message."""
    return nodes.Load("u8", at) if lane is None else nodes.Get("u8", nodes.Place(lane, at))


def lies_in(lane: int | None, at: nodes.Expr) -> nodes.Expr:
    """Whether there is such a byte."""
    low, high = (BEGIN, END) if lane is None else (index(0), nodes.Capacity(lane))
    return nodes.Binary("and", nodes.Compare("ge", at, low), nodes.Compare("lt", at, high))


def put(writer: Writer, at: nodes.Expr, byte: nodes.Expr | int) -> None:
    """Write a byte of the hidden lane."""
    writer.emit(nodes.SetField(nodes.Place(lane_of(writer), at), nodes.Const("u8", byte) if isinstance(byte, int) else byte))


def room(writer: Writer, size: nodes.Expr) -> nodes.Local:
    """Where the next so many bytes of the hidden lane begin; they become part of it by `kept`."""
    writer.emit(nodes.Reserve(lane_of(writer), size))
    start = writer.let("text", nodes.Used(lane_of(writer)))
    for each in has_room(writer, start, size):  # there is: said again, as what is used becomes a long sum where many texts are made
        writer.expect(each, "length", MESSAGE, LOST)
    return start


def kept(writer: Writer, start: nodes.Expr, first: nodes.Expr, after: nodes.Expr, *, valid: bool) -> View:
    """The view of what was written from ``first`` to ``after``, into the room that starts there or before."""
    lane, end = lane_of(writer), writer.let("after", after)
    count = writer.let("written", nodes.Binary("sub", end, start))
    writer.emit(nodes.Reserve(lane, count), nodes.Advance(lane, count))  # there is room: said again where the proof may have lost it
    return sound(writer, View(lane, first, end, valid))


def sound(writer: Writer, view: View, expect: Callable[[nodes.Expr], None] | None = None) -> View:
    """A view that lies where it says. That follows from how it was made; written down, each use of it is proven at a glance.

    Where it follows from a check before, ``expect`` is that check: in a loop, this one may be made before it.
    """
    known = [nodes.Compare("le", view.first, view.after)]
    if view.lane is None:
        known += [nodes.Compare("ge", view.first, BEGIN), nodes.Compare("le", view.after, END)]
    else:
        known += [nodes.Compare("ge", view.first, index(0)), nodes.Compare("le", view.after, nodes.Capacity(view.lane))]
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
        writer.emit(nodes.Advance(lane, index(len(text.text))))
        return
    size = writer.let("size", text.size)
    start = room(writer, size)
    if text.lane == lane:
        writer.expect(nodes.Compare("le", text.after, start), "length", MESSAGE, LOST)
    writer.emit(nodes.Copy(nodes.Place(lane, start), text.address, size), nodes.Advance(lane, size))


def joined(writer: Writer, texts: Iterable[Text]) -> View:
    """One text of several."""
    pieces = tuple(texts)
    start = writer.let("text", nodes.Used(lane_of(writer)))
    for piece in pieces:
        append(writer, piece)
    valid = all(isinstance(piece, Quoted) or piece.valid for piece in pieces)
    return sound(writer, View(lane_of(writer), start, writer.let("after", nodes.Used(lane_of(writer))), valid))


def placed(writer: Writer, text: Text) -> View:
    """A text that lies somewhere."""
    return joined(writer, (text,)) if isinstance(text, Quoted) else text


# --- within routines -----------------------------------------------------------------------------------------------------


def parameters(
    writer: Writer, lane: int | None, names: tuple[str, str] = ("first", "after")
) -> tuple[nodes.Local, nodes.Local, tuple[nodes.Expr, ...]]:
    """The ends of a text that a routine is given, and what it relies on."""
    first, after = (writer.parameter(name, "i64") for name in names)
    low, high = (BEGIN, END) if lane is None else (index(0), nodes.Capacity(lane))
    return first, after, (nodes.Compare("ge", first, low), nodes.Compare("le", first, after), nodes.Compare("le", after, high))


def has_room(writer: Writer, target: nodes.Expr, size: nodes.Expr) -> tuple[nodes.Expr, nodes.Expr]:
    """The precondition of a routine that writes so many bytes to the hidden lane: there is room for them."""
    return nodes.Compare("ge", target, index(0)), nodes.Compare("le", target, nodes.Binary("sub", nodes.Capacity(lane_of(writer)), size))


def between(value: nodes.Expr, low: nodes.Expr, high: nodes.Expr) -> nodes.Expr:
    """A value that is known to lie there, so that the proof knows it too: that it is not too low at once."""
    return nodes.Binary("max", nodes.Binary("min", value, high), low)


def within(first: nodes.Expr, *inside: nodes.Expr, after: nodes.Expr) -> tuple[nodes.Expr, ...]:
    """A routine's promise: the places that it gives are in order, from one end of a text to the other."""
    places = (first, *inside, after)
    return tuple(nodes.Compare("le", before, behind) for before, behind in itertools.pairwise(places))


@dataclass(frozen=True, slots=True)
class Scan:
    """A byte at a place; ``done`` is a variable that ends the scan."""

    at: nodes.Local
    byte: nodes.Local
    done: nodes.Local


@contextmanager
def scanning(
    writer: Writer,
    lane: int | None,
    first: nodes.Expr,
    after: nodes.Expr,
    keeps: Callable[[nodes.Local], tuple[nodes.Expr, ...]] = lambda _: (),
) -> Generator[Scan]:
    """A block that looks at each byte of a text in turn; ``keeps`` says what holds at each place."""
    at, done = writer.var("at", first), writer.var("done", nodes.Const("bool", value=False))
    with writer.nested() as body:
        yield Scan(at, writer.let("byte", byte_at(lane, at)), done)
        writer.assign(at, nodes.Select(done, after, add(at, 1)))
    writer.emit(nodes.While(nodes.Compare("lt", at, after), block(body), (*within(first, at, after=after), *keeps(at)), at))


def is_one_of(byte: nodes.Expr, characters: bytes) -> nodes.Expr:
    """Whether a byte is among some, of which there is one at least."""
    found: nodes.Expr = nodes.Compare("eq", byte, nodes.Const("u8", characters[0]))
    for character in characters[1:]:
        found = nodes.Binary("or", found, nodes.Compare("eq", byte, nodes.Const("u8", character)))
    return found


def is_between(byte: nodes.Expr, low: int, high: int) -> nodes.Expr:
    """Whether a byte lies between two, both included."""
    return nodes.Binary("and", nodes.Compare("ge", byte, nodes.Const("u8", low)), nodes.Compare("le", byte, nodes.Const("u8", high)))


TRUE = nodes.Const("bool", value=True)
