"""Messages of recursive structs: read breadth first, from a work list, so that no nesting needs a stack."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Binary, Compare, Const, Expr, Get, If, Local, Place, Used, While
from rosetta_jit.kernel.terms import BEGIN, END, add, index, joined
from rosetta_jit.lowering.codec.holder_fields import Cell, HolderFields
from rosetta_jit.lowering.codec.tagged import read_message
from rosetta_jit.lowering.codec.work_list import BEGIN_WORD, DEPTH_WORD, END_WORD, MORE_WORD, in_scratch, link
from rosetta_jit.lowering.limits import MAX_RECURSION
from rosetta_jit.lowering.writer import Where, Writer, block
from rosetta_jit.model.layout import Layout
from rosetta_jit.wire.codec import Encoding, Tagged


def cursors(writer: Writer, layout: Layout) -> dict[int, Local]:
    """For each recursive lane, the next row to be read; before the message, since it adds the first."""
    return {lane: writer.var("cursor", Used(lane)) for lane, _ in layout.recursive}


def read_rows(encoding: Encoding, fields: HolderFields, writer: Writer, rows: dict[int, Local]) -> None:
    """Read every row that the message, and the rows themselves, have added. There are fewer than bytes."""
    if not rows:
        return
    limit = writer.let("limit", add(Binary("sub", END, BEGIN), 1))
    done = writer.var("done", index(0))
    pending = joined("or", [Compare("lt", cursor, Used(lane)) for lane, cursor in rows.items()])
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
    writer.expect(_between(depth, index(1), index(MAX_RECURSION)), "nesting", Where(), "the holder is damaged")
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
            writer.expect(in_scratch(more, Used(scratch)), "length", inner.where, "the holder is damaged")
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
