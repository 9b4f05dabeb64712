"""The work list of recursive structs: where messages lie that are read, or written, later.

Each such message is a row of a lane, and the rows of the lanes are the work list: reading a message only notes where the messages
within it lie (`BEGIN_WORD`, `END_WORD`), and takes rows for them at the end of their lane. Each row is read in its turn. A
singular message that comes in several pieces merges: the pieces are chained in the scratch lane.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import Advance, Binary, Compare, Expr, Fill, Get, If, Place, Reserve, SetField, Used
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.lowering.codec.holder_fields import span_of
from rosetta_jit.lowering.codec.unknown_fields import skip
from rosetta_jit.lowering.codec.varint import read_length
from rosetta_jit.lowering.limits import MAX_RECURSION
from rosetta_jit.lowering.writer import Where, Writer, block
from rosetta_jit.model.layout import Layout
from rosetta_jit.wire.codec import Entry, Recursion

if TYPE_CHECKING:
    from rosetta_jit.lowering.codec.tagged_message import Message

BEGIN_WORD, END_WORD, MORE_WORD, LAST_WORD, DEPTH_WORD, SIZE_WORD = range(6)
"""The hidden words of a row: its first piece, the chain of more pieces (1 + a row of the scratch lane), its depth, its size."""


def link(layout: Layout, lane: int, row: Expr, word: int) -> Place:
    """A hidden word of a row."""
    links = layout.lanes[lane].links
    assert links is not None
    return Place(lane, row, links + 8 * word)


def read_recursive(message: Message, entry: Entry, recursion: Recursion, where: Where) -> None:
    """Note where a message lies; it is read later."""
    writer, fields = message.writer, message.fields
    begin, end = _piece(message, recursion, where)
    span = span_of(fields.find(entry.path))
    if entry.label != "single":
        _new_row(message, span.lane, begin, end, where)
        return
    start, count = fields.read_span(fields.find(entry.path), where)
    with writer.nested() as first:
        row = _new_row(message, span.lane, begin, end, where)
        fields.set_span(fields.find(entry.path), row, index(1))
    with writer.nested() as more:
        _chain(writer, fields.layout, span.lane, start, begin, end)
    writer.emit(If(Compare("eq", count, index(0)), block(first), block(more)))


def _piece(message: Message, recursion: Recursion, where: Where) -> tuple[Expr, Expr]:
    """Begin and end of a message. The position moves behind it, and behind the end tag of a group."""
    writer = message.writer
    if recursion.group is None:
        size = read_length(writer, where, message.stop)
        begin = writer.let("begin_of_message", writer.position)
        writer.advance(size)
        return begin, writer.position
    begin = writer.let("begin_of_message", writer.position)
    tag = writer.let("tag", index(recursion.group << 3 | 3))
    return begin, skip(writer, len(message.fields.layout.lanes), tag, message.stop, where)


def _new_row(message: Message, lane: int, begin: Expr, end: Expr, where: Where) -> Expr:
    writer, layout = message.writer, message.fields.layout
    depth = writer.let("depth", add(message.depth, 1))
    writer.expect(Compare("le", depth, index(MAX_RECURSION)), "nesting", where, f"more than {MAX_RECURSION} messages within each other")
    row = message.fields.reserve(lane, index(1))
    writer.emit(
        Fill(Place(lane, row), index(layout.lanes[lane].stride)),
        SetField(link(layout, lane, row, BEGIN_WORD), begin),
        SetField(link(layout, lane, row, END_WORD), end),
        SetField(link(layout, lane, row, DEPTH_WORD), depth),
    )
    return row


def _chain(writer: Writer, layout: Layout, lane: int, row: Expr, begin: Expr, end: Expr) -> None:
    """One more piece of a message that is known already: begin, end and the next piece, three words of the scratch lane."""
    scratch = len(layout.lanes)
    writer.emit(Reserve(scratch, index(3)))
    piece = writer.let("piece", Used(scratch))
    writer.emit(
        Advance(scratch, index(3)),
        SetField(Place(scratch, piece), begin),
        SetField(Place(scratch, add(piece, 1)), end),
        SetField(Place(scratch, add(piece, 2)), index(0)),
    )
    last = writer.let("last", Get("i64", link(layout, lane, row, LAST_WORD)))
    place = add(piece, 1)
    with writer.nested() as second:
        writer.emit(SetField(link(layout, lane, row, MORE_WORD), place))
    with writer.nested() as later:
        known = in_scratch(last, piece)
        writer.expect(known, "length", Where(), "the holder is damaged")
        writer.emit(SetField(Place(scratch, add(last, 1)), place))
    writer.emit(If(Compare("eq", last, index(0)), block(second), block(later)))
    writer.emit(SetField(link(layout, lane, row, LAST_WORD), place))


def in_scratch(number: Expr, used: Expr) -> Expr:
    """Whether 1 + a row of the scratch lane, and the two rows behind it, are in use."""
    return Binary("and", Compare("ge", number, index(1)), Compare("le", number, Binary("sub", used, index(2))))
