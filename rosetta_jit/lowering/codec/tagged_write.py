"""Writing tagged messages (protobuf), and their sizes: fields in the order of their numbers.

A message within another comes after its length. `size` computes all lengths and leaves them in the scratch lane in the order in which
`encode` meets them, so each message is measured once however deep it lies.
"""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import BEGIN, END, add, index, mul
from rosetta_jit.kernel.walk import statements
from rosetta_jit.lowering.codec.fields import converted, scalar_name
from rosetta_jit.lowering.codec.holder_fields import Cell, HolderFields, span_of
from rosetta_jit.lowering.codec.varint import VARINT_BYTES
from rosetta_jit.lowering.codec.varint_write import size_of_varint, to_varint, varint_bytes, write_varint
from rosetta_jit.lowering.limits import MAX_SIZE
from rosetta_jit.lowering.writer import Where, Writer, block
from rosetta_jit.model.layout import UNKNOWN, Row, Span, Variant
from rosetta_jit.model.layout import Number as NumberSlot
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Blob, Entry, Number, Recursion, Tagged, Varint


@dataclass(frozen=True, slots=True)
class Lengths:
    """The scratch lane of lengths, the number of the next one, and how messages of recursive structs are written."""

    lane: int
    next: nodes.Local
    write_child: Callable[[Writer, HolderFields, Cell, Recursion, Where], None]


def write_message(writer: Writer, fields: HolderFields, tagged: Tagged, lengths: Lengths) -> None:
    """Write the fields that are there."""
    for entry in tagged.entries:
        there = present(fields, entry)
        if there is None:
            _write_entry(writer, fields, entry, lengths)
            continue
        if entry.path[0] in tagged.required:
            where = fields.shown(entry.path)
            writer.expect(there, "missing", where, "a required field is not set")
            _write_entry(writer, fields, entry, lengths)
            continue
        after = writer.var("next", writer.position)
        with writer.nested() as body:
            _write_entry(writer, fields, entry, lengths)
            writer.assign(after, writer.position)
        writer.emit(nodes.If(there, block(body)))
        writer.position = after
        _say_again(writer, fields, lengths, body)
    _write_unknown(writer, fields)


def _write_unknown(writer: Writer, fields: HolderFields) -> None:
    """The fields that reading did not know, as they came. Mostly there are none; to call what copies nothing costs as much as a field."""
    row = fields.cell.slot
    if not isinstance(row, Row) or row.unknown is None:
        return
    where = fields.where.member(UNKNOWN)
    start, size = fields.read_span(fields.find((UNKNOWN,)), where)
    writer.require(size, where, "no room for the message")
    if writer.direction == "encode":
        copied = nodes.Copy(nodes.Wire(writer.position), nodes.Place(row.unknown.lane, start), size)
        writer.emit(nodes.If(nodes.Compare("gt", size, index(0)), (copied,)))
    writer.advance(size)


def changes(lengths: Lengths, body: nodes.Block) -> bool:
    """Whether statements write lengths, or read them."""
    return any(isinstance(each, nodes.Assign) and each.name == lengths.next.name for each, _ in statements(body))


def _say_again(writer: Writer, fields: HolderFields, lengths: Lengths, body: list[nodes.Stmt]) -> None:
    """Behind an optional field, which ``body`` writes: what holds whether it was there or not, where the proof may not follow by itself."""
    if writer.direction == "encode":
        inside = nodes.Binary("and", nodes.Compare("ge", writer.position, BEGIN), nodes.Compare("le", writer.position, END))
        writer.expect(inside, "length", fields.where, "the holder changed while it was written")
    if changes(lengths, block(body)):
        known = nodes.Binary(
            "and", nodes.Compare("ge", lengths.next, index(0)), nodes.Compare("le", lengths.next, nodes.Capacity(lengths.lane))
        )
        writer.expect(known, "length", fields.where, "the holder changed while it was written")


def present(fields: HolderFields, entry: Entry) -> nodes.Expr | None:
    """Whether a field is written; None where it always is, or its count tells."""
    row = fields.cell.slot
    assert isinstance(row, Row)
    member = row.member(entry.path[0])
    if member.presence is not None:
        word = nodes.Get("u64", fields.cell.place(row.offset + 8 * (member.presence // 64)))
        return nodes.Compare("ne", nodes.Binary("and", word, nodes.Const("u64", 1 << member.presence % 64)), nodes.Const("u64", 0))
    if isinstance(member.slot, Variant) and len(entry.path) > 1:
        number = next(n for n, case in enumerate(member.slot.members, 1) if case.name == entry.path[1])
        return nodes.Compare("eq", nodes.Get("i64", fields.cell.place(member.slot.offset)), index(number))
    if not entry.implicit:
        return None
    match fields.find(entry.path).slot:
        case NumberSlot(offset, scalar):
            return _not_zero(fields, offset, scalar)
        case Span(offset, _):
            return nodes.Compare("ne", nodes.Get("i64", fields.cell.place(offset + 8)), index(0))
        case _:
            return None


def _not_zero(fields: HolderFields, offset: int, scalar: str) -> nodes.Expr:
    """Numbers are compared by their bits: -0.0 is written."""
    bits = {"f32": "u32", "f64": "u64"}.get(scalar, scalar)
    type_ = scalar_name(bits)
    return nodes.Compare("ne", nodes.Get(type_, fields.cell.place(offset)), nodes.Const(type_, value=False if type_ == "bool" else 0))


def _write_entry(writer: Writer, fields: HolderFields, entry: Entry, lengths: Lengths) -> None:
    where = fields.shown(entry.path)
    match entry.label:
        case "single":
            write_tag(writer, entry.number, entry.wire, where)
            _write_value(writer, fields, entry, fields.find(entry.path), where, lengths)
        case "repeated":
            _write_elements(writer, fields, entry, where, lengths)
        case "packed":
            _write_packed(writer, fields, entry, where, lengths)


def write_tag(writer: Writer, number: int, wire: int, where: Where) -> None:
    """The number of a field and its wire type."""
    for byte in varint_bytes(number << 3 | wire):
        writer.store(nodes.Const("u8", byte), where)


def _write_value(writer: Writer, fields: HolderFields, entry: Entry, cell: Cell, where: Where, lengths: Lengths) -> None:
    """One value without its tag."""
    match entry.value:
        case Number(_, scalar, order):
            writer.store(converted(_number(cell), scalar), where, order)
        case Varint() as varint:
            write_varint(writer, to_varint(varint, _number(cell)), where)
        case Blob():
            start, size = fields.read_span(cell, where)
            if writer.direction == "size":
                writer.advance(add(size_of_varint(writer, nodes.Convert("u64", size), where), size))
                return
            write_varint(writer, nodes.Convert("u64", size), where)
            writer.require(size, where, "no room for the message")
            writer.emit(nodes.Copy(nodes.Wire(writer.position), nodes.Place(span_of(cell).lane, start), size))
            writer.advance(size)
        case Tagged(group=int(number)) as tagged:
            write_message(writer, HolderFields(writer, fields.layout, cell, where), tagged, lengths)
            write_tag(writer, number, 4, where)
        case Tagged() as tagged:
            inner = HolderFields(writer, fields.layout, cell, where)
            _delimited(writer, where, lengths, lambda: write_message(writer, inner, tagged, lengths))
        case Recursion() as recursion if isinstance(cell.slot, Span) and present(fields, entry) is None:
            _write_perhaps(writer, fields, cell, recursion, where, lengths)
        case Recursion() as recursion:
            lengths.write_child(writer, fields, _child(fields, cell, where), recursion, where)
        case _:
            raise AssertionError(entry)


def _write_perhaps(writer: Writer, fields: HolderFields, cell: Cell, recursion: Recursion, where: Where, lengths: Lengths) -> None:
    """The message that a map's entry always has, though it may not have come: then it is empty."""
    start, count = fields.read_span(cell, where)
    lane, after = span_of(cell).lane, writer.var("next", writer.position)
    with writer.nested() as there:
        writer.expect(nodes.Compare("eq", count, index(1)), "length", where, "the holder is damaged")
        lengths.write_child(writer, fields, Cell(lane, start, fields.layout.lanes[lane].element), recursion, where)
        writer.assign(after, writer.position)
    with writer.nested() as empty:
        if recursion.group is None:
            write_varint(writer, nodes.Const("u64", 0), where)
        else:
            write_tag(writer, recursion.group, 4, where)
        writer.assign(after, writer.position)
    writer.emit(nodes.If(nodes.Compare("gt", count, index(0)), block(there), block(empty)))
    writer.position = after
    _say_again(writer, fields, lengths, there)


def _child(fields: HolderFields, cell: Cell, where: Where) -> Cell:
    """The row of a message of a recursive struct: the element itself, or the one row that a singular field refers to."""
    if not isinstance(cell.slot, Span):
        return cell
    start, count = fields.read_span(cell, where)
    fields.writer.expect(nodes.Compare("eq", count, index(1)), "length", where, "the holder is damaged")
    return Cell(cell.slot.lane, start, fields.layout.lanes[cell.slot.lane].element)


def _number(cell: Cell) -> nodes.Expr:
    assert isinstance(cell.slot, NumberSlot)
    return nodes.Get(scalar_name(cell.slot.scalar), cell.place(cell.slot.offset))


def _delimited(writer: Writer, where: Where, lengths: Lengths, write: object) -> None:
    """Something after its length. To size it, note its length; to write it, look that up, and see that it was right."""
    assert callable(write)
    number = writer.let("length", lengths.next)
    if writer.direction == "size":
        writer.emit(nodes.Reserve(lengths.lane, add(number, 1)))
        writer.assign(lengths.next, add(number, 1))
        before, writer.position = writer.position, index(0)
        write()
        size = writer.let("size", writer.position)
        writer.emit(nodes.SetField(nodes.Place(lengths.lane, number), size))
        writer.position = before
        writer.advance(add(size_of_varint(writer, nodes.Convert("u64", size), where), size))
        return
    known = nodes.Compare("lt", number, nodes.Capacity(lengths.lane))
    writer.expect(known, "length", where, "the holder changed while it was written")
    writer.assign(lengths.next, add(number, 1))
    size = writer.let("size", nodes.Get("i64", nodes.Place(lengths.lane, number)))
    write_varint(writer, nodes.Convert("u64", size), where)
    begin = writer.let("begin_of_message", writer.position)
    writer.position = begin
    write()
    right = nodes.Compare("eq", nodes.Binary("sub", writer.position, begin), size)
    writer.expect(right, "length", where, "the holder changed while it was written")


def _write_elements(writer: Writer, fields: HolderFields, entry: Entry, where: Where, lengths: Lengths) -> None:
    """Each element with its tag."""
    cell = fields.find(entry.path)
    start, count = fields.read_span(cell, where)
    lane = span_of(cell).lane
    number, at = writer.var("i", index(0)), writer.cursor()
    with writer.nested() as body:
        writer.position = at
        element = Cell(lane, nodes.Binary("add", start, number), fields.layout.lanes[lane].element)
        place = where.element(number)
        write_tag(writer, entry.number, entry.wire, place)
        _write_value(writer, fields, entry, element, place, lengths)
        writer.settle()
        writer.emit(nodes.Assign(at.name, writer.position), nodes.Assign(number.name, add(number, 1)))
    invariant = (
        nodes.Compare("ge", number, index(0)),
        *writer.position_invariant(at),
        nodes.Compare("ge", lengths.next, index(0)),
        nodes.Compare("le", lengths.next, nodes.Capacity(lengths.lane)),
    )
    writer.emit(nodes.While(nodes.Compare("lt", number, count), block(body), invariant, number))
    writer.position = at


def _write_packed(writer: Writer, fields: HolderFields, entry: Entry, where: Where, lengths: Lengths) -> None:
    """All elements behind one tag and their length; nothing for none."""
    cell = fields.find(entry.path)
    start, count = fields.read_span(cell, where)
    after = writer.var("next", writer.position)
    with writer.nested() as body:
        write_tag(writer, entry.number, 2, where)
        if isinstance(entry.value, Number):
            _packed_fixed(writer, fields, cell, start, count, entry.value, where)
        else:
            _delimited(writer, where, lengths, lambda: _packed_varints(writer, fields, cell, start, count, entry, where, lengths))
        writer.assign(after, writer.position)
    writer.emit(nodes.If(nodes.Compare("gt", count, index(0)), block(body)))
    writer.position = after
    _say_again(writer, fields, lengths, body)


def _packed_fixed(
    writer: Writer, fields: HolderFields, cell: Cell, start: nodes.Expr, count: nodes.Expr, number: Number, where: Where
) -> None:
    width, scalar = nodes.WIDTH[number.scalar], scalar_name(number.scalar)
    writer.expect(nodes.Compare("le", count, index(MAX_SIZE // width)), "length", where, "too many numbers")
    size = writer.let("size", mul(count, width))
    write_varint(writer, nodes.Convert("u64", size), where)
    writer.require(size, where, "no room for the message")
    if writer.direction == "encode":
        lane = span_of(cell).lane
        slot = fields.layout.lanes[lane].element
        assert isinstance(slot, NumberSlot)
        first, item = writer.position, nodes.Local("i64", writer.fresh("i"))
        with writer.nested() as body:
            value = nodes.Get(scalar_name(slot.scalar), nodes.Place(lane, nodes.Binary("add", start, item)))
            writer.position = writer.let("item", nodes.Binary("add", first, mul(item, width)))
            writer.require(width, where)
            writer.emit(nodes.Store(writer.position, converted(value, scalar), ">" if number.order == ">" else "<"))
        writer.emit(nodes.For(item.name, count, block(body)))
    writer.advance(size)


def _packed_varints(
    writer: Writer, fields: HolderFields, cell: Cell, start: nodes.Expr, count: nodes.Expr, entry: Entry, where: Where, lengths: Lengths
) -> None:
    lane = span_of(cell).lane
    slot = fields.layout.lanes[lane].element
    if writer.direction == "size" and isinstance(entry.value, Varint):
        _measure_varints(writer, fields, lane, start, count, entry.value, where)
        return
    number, at = writer.var("i", index(0)), writer.cursor()
    with writer.nested() as body:
        writer.position = at
        _write_value(writer, fields, entry, Cell(lane, nodes.Binary("add", start, number), slot), where.element(number), lengths)
        writer.settle()
        writer.emit(nodes.Assign(at.name, writer.position), nodes.Assign(number.name, add(number, 1)))
    invariant = (nodes.Compare("ge", number, index(0)), *writer.position_invariant(at))
    writer.emit(nodes.While(nodes.Compare("lt", number, count), block(body), invariant, number))
    writer.position = at


def _measure_varints(
    writer: Writer, fields: HolderFields, lane: int, start: nodes.Expr, count: nodes.Expr, varint: Varint, where: Where
) -> None:
    """The bytes of all elements. There are so few of them that no sum can be too large, so that nothing is checked in the loop."""
    writer.expect(nodes.Compare("le", count, index(MAX_SIZE // VARINT_BYTES)), "length", where, "too many numbers")
    writer.settle()
    first = writer.let("first", writer.position)
    number, at = writer.var("i", index(0)), writer.var("next", first)
    with writer.nested() as body:
        cell = Cell(lane, nodes.Binary("add", start, number), fields.layout.lanes[lane].element)
        size = size_of_varint(writer, to_varint(varint, _number(cell)), where.element(number))
        writer.emit(nodes.Assign(at.name, nodes.Binary("add", at, size)), nodes.Assign(number.name, add(number, 1)))
    most = nodes.Compare("le", at, nodes.Binary("add", first, mul(number, VARINT_BYTES)))
    invariant = (nodes.Compare("ge", number, index(0)), nodes.Compare("le", number, count), nodes.Compare("ge", at, first), most)
    writer.emit(nodes.While(nodes.Compare("lt", number, count), block(body), invariant, number))
    writer.position = at
    writer.settle()
