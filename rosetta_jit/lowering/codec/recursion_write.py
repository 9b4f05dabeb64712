"""Writing messages of recursive structs, and their sizes, without a stack.

The scratch lane holds, from row 0 on: the number of rows n, where the lengths of the root message start, the n rows (parents before
children; each behind its lane, where there are several), then the lengths. To measure, the list is made and gone through from its end; to
write, from its start. Where the rows of one lane are in that order already, they are the list, which is not made.
"""

from __future__ import annotations

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import BEGIN, END, add, index, joined, mul
from rosetta_jit.lowering.codec.holder_fields import Cell, HolderFields, span_of
from rosetta_jit.lowering.codec.tagged_write import Lengths, changes, present, write_message, write_tag
from rosetta_jit.lowering.codec.varint_write import write_varint
from rosetta_jit.lowering.codec.work_list import BEGIN_WORD, MORE_WORD, SIZE_WORD, link
from rosetta_jit.lowering.limits import MAX_SIZE
from rosetta_jit.lowering.writer import Where, Writer, block
from rosetta_jit.model.layout import Layout
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.wire.codec import Encoding, Entry, Recursion, Tagged

HEADER = 2
"""Rows of the scratch lane before the list."""

DAMAGED = "the holder changed while it was written"


@dataclass(frozen=True, slots=True)
class Rows:
    """The list of rows: the scratch lane, how many words of it each takes, how many rows there are, and how many there can be."""

    scratch: int
    words: int
    number: nodes.Local
    most: nodes.Expr


def has_recursion(tagged: Tagged) -> bool:
    """Whether a message has recursive ones among its fields, or theirs."""
    return any(_is_recursive(entry) for entry in tagged.entries)


def _is_recursive(entry: Entry) -> bool:
    return isinstance(entry.value, Recursion) or (isinstance(entry.value, Tagged) and has_recursion(entry.value))


def write_root(encoding: Encoding, fields: HolderFields, tagged: Tagged, writer: Writer) -> None:
    """The message itself and all rows below it."""
    scratch = len(fields.layout.lanes)
    if not has_recursion(tagged):
        write_message(writer, fields, tagged, Lengths(scratch, writer.var("lengths", index(0)), write_child))
    elif writer.direction == "size":
        _measure(encoding, fields, tagged, writer, scratch)
    else:
        _write(encoding, fields, tagged, writer, scratch)


def write_child(writer: Writer, fields: HolderFields, cell: Cell, recursion: Recursion, where: Where) -> None:
    """The place of a message within another: its size is known, and it is told where it belongs."""
    lane, row = cell.lane, cell.row
    size = writer.let("size", nodes.Get("i64", link(fields.layout, lane, row, SIZE_WORD)))
    sane = nodes.Binary("and", nodes.Compare("ge", size, index(0)), nodes.Compare("le", size, index(MAX_SIZE)))
    writer.expect(sane, "length", where, DAMAGED)
    if recursion.group is None:
        write_varint(writer, nodes.Convert("u64", size), where)
    if writer.direction == "encode":
        writer.emit(nodes.SetField(link(fields.layout, lane, row, BEGIN_WORD), writer.position))
    writer.require(size, where, "no room for the message")
    writer.advance(size)
    if recursion.group is not None:
        write_tag(writer, recursion.group, 4, where)


# --- measuring -----------------------------------------------------------------------------------------------------------------


def _measure(encoding: Encoding, fields: HolderFields, tagged: Tagged, writer: Writer, scratch: int) -> None:
    if (lane := _lane_in_order(writer, fields.layout)) is not None:
        count, words = writer.let("count", nodes.Used(lane)), 0
    else:
        rows = _list_rows(encoding, fields, tagged, writer, scratch)
        count, words = writer.let("count", rows.number), rows.words
    first = writer.let("first_length", add(mul(count, words), HEADER))
    writer.emit(nodes.Reserve(scratch, first))
    lengths = Lengths(scratch, writer.var("lengths", first), write_child)
    back = writer.var("back", index(0))
    with writer.nested() as body:
        writer.position = index(0)
        _each_lane(encoding, fields, writer, scratch, nodes.Binary("sub", nodes.Binary("sub", count, back), index(1)), lengths)
        writer.assign(back, add(back, 1))
    writer.emit(
        nodes.While(
            nodes.Compare("lt", back, count), block(body), (nodes.Compare("ge", back, index(0)), *_lengths_invariant(lengths)), back
        )
    )
    writer.emit(
        nodes.Reserve(scratch, index(HEADER)),
        nodes.SetField(nodes.Place(scratch, index(0)), count),
        nodes.SetField(nodes.Place(scratch, index(1)), lengths.next),
    )
    writer.position = index(0)
    write_message(writer, fields, tagged, lengths)


def _list_rows(encoding: Encoding, fields: HolderFields, tagged: Tagged, writer: Writer, scratch: int) -> Rows:
    most = joined("add", [nodes.Used(lane) for lane, _ in fields.layout.recursive])
    rows = Rows(scratch, _words(fields.layout), writer.var("rows", index(0)), writer.let("most", most))
    _visit(writer, fields, tagged, rows)
    at = writer.var("at_row", index(0))
    with writer.nested() as body:
        cases = [(lane, _visit_row(writer, fields, encoding.recursive[struct], lane, rows, at)) for lane, struct in fields.layout.recursive]
        _by_lane(writer, fields.layout, scratch, at, cases)
        _say_again(writer, rows)
        writer.assign(at, add(at, 1))
    goes_on = nodes.Binary("and", nodes.Compare("lt", at, rows.number), nodes.Compare("lt", at, rows.most))
    writer.emit(nodes.While(goes_on, block(body), (nodes.Compare("ge", at, index(0)), *_rows_invariant(rows)), at))
    return rows


def _visit_row(writer: Writer, fields: HolderFields, tagged: Tagged, lane: int, rows: Rows, at: nodes.Local) -> nodes.Block:
    with writer.nested() as body:
        row = _row_of(writer, fields.layout, rows.scratch, at, lane)
        inner = HolderFields(writer, fields.layout, Cell(lane, row, fields.layout.lanes[lane].element))
        _visit(writer, inner, tagged, rows)
    return block(body)


def _visit(writer: Writer, fields: HolderFields, tagged: Tagged, rows: Rows) -> None:
    """Add all recursive messages among the fields of one to the list."""
    for entry in tagged.entries:
        if not _is_recursive(entry):
            continue
        there = present(fields, entry)
        with writer.nested() as body:
            _visit_field(writer, fields, entry, rows)
        writer.emit(nodes.If(there if there is not None else nodes.Const("bool", value=True), block(body)))
        _say_again(writer, rows)


def _visit_field(writer: Writer, fields: HolderFields, entry: Entry, rows: Rows) -> None:
    if isinstance(entry.value, Tagged) and entry.label == "single":
        inner = HolderFields(writer, fields.layout, fields.find(entry.path), fields.where)
        _visit(writer, inner, entry.value, rows)
        return
    cell = fields.find(entry.path)
    start, count = fields.read_span(cell, fields.shown(entry.path))
    lane, number = span_of(cell).lane, writer.var("i", index(0))
    with writer.nested() as body:
        row = writer.let("row_of_element", nodes.Binary("add", start, number))
        if isinstance(entry.value, Recursion):
            _append(writer, rows, lane, row)
        elif isinstance(entry.value, Tagged):
            inner = HolderFields(writer, fields.layout, Cell(lane, row, fields.layout.lanes[lane].element))
            _visit(writer, inner, entry.value, rows)
        writer.assign(number, add(number, 1))
    invariant = (nodes.Compare("ge", number, index(0)), *_rows_invariant(rows))
    writer.emit(nodes.While(nodes.Compare("lt", number, count), block(body), invariant, number))


def _append(writer: Writer, rows: Rows, lane: int, row: nodes.Expr) -> None:
    writer.expect(
        nodes.Compare("lt", rows.number, rows.most), "nesting", Where(), "a message contains itself, or too many within each other"
    )
    place = writer.let("place", add(mul(rows.number, rows.words), HEADER))
    words = (index(lane), row)[-rows.words :]
    writer.emit(
        nodes.Reserve(rows.scratch, add(place, rows.words)),
        *(nodes.SetField(nodes.Place(rows.scratch, add(place, number)), word) for number, word in enumerate(words)),
    )
    writer.assign(rows.number, add(rows.number, 1))


# --- writing -------------------------------------------------------------------------------------------------------------------


def _write(encoding: Encoding, fields: HolderFields, tagged: Tagged, writer: Writer, scratch: int) -> None:
    writer.expect(nodes.Compare("ge", nodes.Capacity(scratch), index(HEADER)), "length", fields.where, DAMAGED)
    if (lane := _lane_in_order(writer, fields.layout)) is not None:
        count = writer.let("count", nodes.Used(lane))
    else:
        count = writer.let("count", nodes.Get("i64", nodes.Place(scratch, index(0))))
        there = nodes.Binary("and", nodes.Compare("ge", count, index(0)), nodes.Compare("le", count, nodes.Capacity(scratch)))
        writer.expect(there, "length", fields.where, DAMAGED)
    lengths = Lengths(scratch, writer.var("lengths", nodes.Get("i64", nodes.Place(scratch, index(1)))), write_child)
    _expect_lengths(writer, lengths)
    write_message(writer, fields, tagged, lengths)
    end, at = writer.position, writer.var("at_row", index(0))
    with writer.nested() as body:
        _each_lane(encoding, fields, writer, scratch, at, lengths)
        writer.assign(at, add(at, 1))
    writer.emit(
        nodes.While(nodes.Compare("lt", at, count), block(body), (nodes.Compare("ge", at, index(0)), *_lengths_invariant(lengths)), at)
    )
    writer.position = end


def _each_lane(encoding: Encoding, fields: HolderFields, writer: Writer, scratch: int, number: nodes.Expr, lengths: Lengths) -> None:
    """Measure or write the row at a place of the list, whichever lane it is in."""
    at = writer.let("number", number)
    cases = [(lane, _one_row(writer, fields, encoding.recursive[struct], lane, at, lengths)) for lane, struct in fields.layout.recursive]
    _by_lane(writer, fields.layout, scratch, at, cases)
    _expect_lengths(writer, lengths)


def _one_row(writer: Writer, fields: HolderFields, tagged: Tagged, lane: int, at: nodes.Expr, lengths: Lengths) -> nodes.Block:
    layout = fields.layout
    with writer.nested() as body:
        row = _row_of(writer, layout, lengths.lane, at, lane)
        inner = HolderFields(writer, layout, Cell(lane, row, layout.lanes[lane].element), Where(f".{layout.lanes[lane].name}"))
        more, size = link(layout, lane, row, MORE_WORD), link(layout, lane, row, SIZE_WORD)
        if writer.direction == "size":
            lengths = _of_later_rows(row, lengths) if _lane_in_order(writer, layout) is not None else lengths
            writer.position = index(0)
            message, end = _message(writer, inner, tagged, lengths)
            writer.emit(*([nodes.SetField(more, lengths.next)] if changes(lengths, message) else []), *message)
            writer.emit(nodes.SetField(size, end))
        else:
            begin = writer.let("begin_of_message", nodes.Get("i64", link(layout, lane, row, BEGIN_WORD)))
            writer.expect(
                nodes.Binary("and", nodes.Compare("ge", begin, BEGIN), nodes.Compare("le", begin, END)), "length", inner.where, DAMAGED
            )
            writer.position = begin
            message, end = _message(writer, inner, tagged, lengths)
            if changes(lengths, message):
                writer.assign(lengths.next, nodes.Get("i64", more))
                _expect_lengths(writer, lengths)
            writer.emit(*message)
            writer.position = end
            written = nodes.Binary("sub", end, begin)
            writer.expect(nodes.Compare("eq", written, nodes.Get("i64", size)), "length", inner.where, DAMAGED)
    return block(body)


def _of_later_rows(row: nodes.Expr, lengths: Lengths) -> Lengths:
    """For a row that is measured behind all later ones: the messages within it have these, or the rows are in another order."""

    def write_later_child(writer: Writer, fields: HolderFields, cell: Cell, recursion: Recursion, where: Where) -> None:
        writer.expect(nodes.Compare("gt", cell.row, row), "length", where, DAMAGED)
        lengths.write_child(writer, fields, cell, recursion, where)

    return replace(lengths, write_child=write_later_child)


def _message(writer: Writer, fields: HolderFields, tagged: Tagged, lengths: Lengths) -> tuple[nodes.Block, nodes.Expr]:
    """What writes the message of a row, and its end. Where it has no lengths, it need not be known which is the first."""
    with writer.nested() as body:
        write_message(writer, fields, tagged, lengths)
        end = writer.position
    return block(body), end


# --- the list --------------------------------------------------------------------------------------------------------------------


def _words(layout: Layout) -> int:
    """How many words of the scratch lane a row of the list takes: of one lane it needs no number."""
    return min(len(layout.recursive), 2)


def _lane_in_order(writer: Writer, layout: Layout) -> int | None:
    """The lane whose rows are the list as they are; None where there are several, or they may be in another order."""
    return layout.recursive[0][0] if writer.rows_in_order and len(layout.recursive) == 1 else None


def _by_lane(writer: Writer, layout: Layout, scratch: int, at: nodes.Expr, cases: list[tuple[int, nodes.Block]]) -> None:
    """What the lane of a row of the list says."""
    if _words(layout) == 1:
        writer.emit(*cases[0][1])
        return
    writer.emit(nodes.Switch(_listed(writer, layout, scratch, at, 0), tuple(cases), _damaged(writer)))


def _listed(writer: Writer, layout: Layout, scratch: int, at: nodes.Expr, word: int) -> nodes.Expr:
    """One of the words at a place of the list, which is checked to be in the scratch lane."""
    inside = nodes.Binary("and", nodes.Compare("ge", at, index(0)), nodes.Compare("lt", at, index(MAX_SIZE)))
    writer.expect(inside, "length", Where(), DAMAGED)
    place = writer.let("place", add(mul(at, _words(layout)), HEADER + word))
    writer.expect(nodes.Compare("lt", place, nodes.Capacity(scratch)), "length", Where(), DAMAGED)
    return writer.let("listed", nodes.Get("i64", nodes.Place(scratch, place)))


def _row_of(writer: Writer, layout: Layout, scratch: int, at: nodes.Expr, lane: int) -> nodes.Expr:
    row = at if _lane_in_order(writer, layout) is not None else _listed(writer, layout, scratch, at, _words(layout) - 1)
    writer.expect(
        nodes.Binary("and", nodes.Compare("ge", row, index(0)), nodes.Compare("lt", row, nodes.Used(lane))), "length", Where(), DAMAGED
    )
    return row


def _damaged(writer: Writer) -> nodes.Block:
    return (nodes.Expect(nodes.Const("bool", value=False), writer.failure("length", Where(), DAMAGED)),)


def _rows_invariant(rows: Rows) -> tuple[nodes.Expr, ...]:
    return nodes.Compare("ge", rows.number, index(0)), nodes.Compare("le", rows.number, rows.most)


def _say_again(writer: Writer, rows: Rows) -> None:
    """True anyway; said for the proof, which does not follow the number through branches."""
    low, high = _rows_invariant(rows)
    writer.expect(nodes.Binary("and", low, high), "length", Where(), DAMAGED)


def _lengths_invariant(lengths: Lengths) -> tuple[nodes.Expr, ...]:
    return nodes.Compare("ge", lengths.next, index(0)), nodes.Compare("le", lengths.next, nodes.Capacity(lengths.lane))


def _expect_lengths(writer: Writer, lengths: Lengths) -> None:
    low, high = _lengths_invariant(lengths)
    writer.expect(nodes.Binary("and", low, high), "length", Where(), DAMAGED)
