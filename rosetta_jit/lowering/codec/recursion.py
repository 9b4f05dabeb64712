"""Messages of recursive structs: read and written breadth first, from a work list, so that no nesting needs a stack.

Each such message is a row of a lane, and the rows of the lanes are the work list: reading a message only notes where the messages
within it lie (`BEGIN_WORD`, `END_WORD`), and takes rows for them at the end of their lane. Each row is read in its turn. A
singular message that comes in several pieces merges: the pieces are chained in the scratch lane.

To write, a list of all rows is made first, parents before children. Measured from its end, every message knows the sizes of those
within it; written from its start, every message knows where those within it belong.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Advance, Binary, Compare, Const, Expr, Fill, Get, If, Place, Reserve, SetField, Used, While
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.codec.fields import Cell, HolderFields, span_of
from rosetta_jit.lowering.codec.tagged import Message, read_length, read_message
from rosetta_jit.lowering.codec.unknown_fields import skip
from rosetta_jit.lowering.writer import Where, Writer, block

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Local
    from rosetta_jit.model.layout import Layout
    from rosetta_jit.wire.codec import Encoding, Entry, Recursion, Tagged

MAX_DEPTH = 64
"""Messages within each other, of recursive structs: more is an error of kind ``nesting``."""

BEGIN_WORD, END_WORD, MORE_WORD, LAST_WORD, DEPTH_WORD, SIZE_WORD = range(6)
"""The hidden words of a row: its first piece, the chain of more pieces (1 + a row of the scratch lane), its depth, its size."""


def link(layout: Layout, lane: int, row: Expr, word: int) -> Place:
    """A hidden word of a row."""
    links = layout.lanes[lane].links
    assert links is not None
    return Place(lane, row, links + 8 * word)


# --- reading -------------------------------------------------------------------------------------------------------------------


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
    """Where a message begins and ends; the position is moved behind it, and behind the end tag of a group."""
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
    writer.expect(Compare("le", depth, index(MAX_DEPTH)), "nesting", where, f"more than {MAX_DEPTH} messages within each other")
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
        known = _in_scratch(last, piece)
        writer.expect(known, "length", Where(), "the holder is damaged")
        writer.emit(SetField(Place(scratch, add(last, 1)), place))
    writer.emit(If(Compare("eq", last, index(0)), block(second), block(later)))
    writer.emit(SetField(link(layout, lane, row, LAST_WORD), place))


def _in_scratch(number: Expr, used: Expr) -> Expr:
    """Whether 1 + a row of the scratch lane, and the two rows behind it, are in use."""
    return Binary("and", Compare("ge", number, index(1)), Compare("le", number, Binary("sub", used, index(2))))


def cursors(writer: Writer, layout: Layout) -> dict[int, Local]:
    """For each recursive lane, the next row to be read; before the message, since it adds the first."""
    return {lane: writer.var("cursor", Used(lane)) for lane, _ in layout.recursive}


def read_rows(encoding: Encoding, fields: HolderFields, writer: Writer, rows: dict[int, Local]) -> None:
    """Read every row that the message, and the rows themselves, have added. There are fewer than bytes."""
    if not rows:
        return
    limit = writer.let("limit", add(Binary("sub", END, BEGIN), 1))
    done = writer.var("done", index(0))
    pending: Expr | None = None
    for lane, cursor in rows.items():
        waits = Compare("lt", cursor, Used(lane))
        pending = waits if pending is None else Binary("or", pending, waits)
    assert pending is not None
    end = writer.position
    with writer.nested() as body:
        for lane, struct in fields.layout.recursive:
            cursor = rows[lane]
            with writer.nested() as one:
                _read_row(encoding.recursive[struct], fields, writer, lane, cursor)
                writer.assign(cursor, add(cursor, 1))
            writer.emit(If(Compare("lt", cursor, Used(lane)), block(one)))
        for lane, cursor in rows.items():  # true anyway; said for the proof, which does not follow them through the branches
            writer.expect(_between(cursor, index(0), Used(lane)), "length", Where(), "the holder is damaged")
        writer.assign(done, add(done, 1))
    invariant: list[Expr] = [Compare("ge", done, index(0)), Compare("le", done, limit)]
    for lane, cursor in rows.items():
        invariant += [Compare("ge", cursor, index(0)), Compare("le", cursor, Used(lane))]
    writer.emit(While(Binary("and", Compare("lt", done, limit), pending), block(body), tuple(invariant), done))
    writer.position = end


def _read_row(tagged: Tagged, fields: HolderFields, writer: Writer, lane: int, row: Expr) -> None:
    """Read the pieces of one row."""
    layout, scratch = fields.layout, len(fields.layout.lanes)
    words = [writer.let("word", Get("i64", link(layout, lane, row, word))) for word in (BEGIN_WORD, END_WORD, MORE_WORD, DEPTH_WORD)]
    depth = words[3]
    writer.expect(_between(depth, index(1), index(MAX_DEPTH)), "nesting", Where(), "the holder is damaged")
    begin, end, more = writer.var("begin_of_piece", words[0]), writer.var("end_of_piece", words[1]), writer.var("more", words[2])
    pieces, goes_on = writer.var("pieces", index(0)), writer.var("goes_on", Const("bool", value=True))
    limit = writer.let("limit", add(Binary("sub", END, BEGIN), 1))
    inner = HolderFields(writer, layout, Cell(lane, row, layout.lanes[lane].element), Where(_path(layout, lane)), fields.borrow)
    with writer.nested() as body:
        writer.expect(Binary("and", _between(begin, BEGIN, end), Compare("le", end, END)), "length", inner.where, "the holder is damaged")
        writer.position = begin
        read_message(writer, inner, tagged, end, fresh=False, depth=depth)
        writer.assign(pieces, add(pieces, 1))
        with writer.nested() as another:
            writer.expect(_in_scratch(more, Used(scratch)), "length", inner.where, "the holder is damaged")
            piece = writer.let("piece", add(more, -1))
            writer.assign(begin, Get("i64", Place(scratch, piece)))
            writer.assign(end, Get("i64", Place(scratch, add(piece, 1))))
            writer.assign(more, Get("i64", Place(scratch, add(piece, 2))))
        with writer.nested() as last:
            writer.assign(goes_on, Const("bool", value=False))
        writer.emit(If(Compare("ne", more, index(0)), block(another), block(last)))
    invariant = (Compare("ge", pieces, index(0)), Compare("le", pieces, limit))
    writer.emit(While(Binary("and", goes_on, Compare("lt", pieces, limit)), block(body), invariant, pieces))


def _between(value: Expr, low: Expr, high: Expr) -> Expr:
    return Binary("and", Compare("ge", value, low), Compare("le", value, high))


def _path(layout: Layout, lane: int) -> str:
    """The path of a recursive lane, without indices: its rows are of all depths."""
    return "." + layout.lanes[lane].name.replace("{", "{{").replace("}", "}}")
