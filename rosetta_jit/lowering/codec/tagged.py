"""Tagged messages (protobuf): the one place where the two directions honestly differ.

Reading takes fields in any order: the last value of a single field wins, messages merge, arrays grow, unknown fields are skipped.
Writing goes through the fields in the order of their numbers.

The elements of one array lie together although the wire may interleave fields, because each array path has a lane of its own and nothing
else is appended to it while its message is being read. So a message notes where its arrays start, and their counts follow at its end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.codec.field_order import NONE, Case, read_cases
from rosetta_jit.lowering.codec.fields import converted, scalar_name
from rosetta_jit.lowering.codec.holder_fields import Cell, HolderFields, span_of
from rosetta_jit.lowering.codec.packed import read_fixed, read_varints, reads_several
from rosetta_jit.lowering.codec.runs import has_runs, has_runs_of_varints, read_run, read_run_of_varints
from rosetta_jit.lowering.codec.tagged_message import (
    Message,
    array_starts,
    clear_other_case,
    lane_of,
    mark,
    presence_words,
    row_of,
    set_number,
)
from rosetta_jit.lowering.codec.unknown_fields import skip_unknown
from rosetta_jit.lowering.codec.varint import from_varint, read_element, read_length, read_packed, read_tag, read_varint
from rosetta_jit.lowering.codec.varint_write import varint_bytes
from rosetta_jit.lowering.writer import Where, Writer, block
from rosetta_jit.model.layout import Number as NumberSlot
from rosetta_jit.model.layout import Slot, Span
from rosetta_jit.wire.codec import Blob, Entry, Number, Recursion, Tagged, Varint

BYTES, GROUP, END_GROUP = 2, 3, 4


def read_message(
    writer: Writer,
    fields: HolderFields,
    tagged: Tagged,
    stop: nodes.Expr,
    *,
    fresh: bool,
    depth: nodes.Expr,
    strange: nodes.Local | None = None,
) -> None:
    """Read fields up to ``stop`` (or the end of the group) into a row; a ``fresh`` row holds nothing yet, another is merged into.

    ``depth`` is how many messages of recursive structs there are around it; ``strange`` as of `Message`.
    """
    presence = presence_words(writer, fields, fresh=fresh)
    message = Message(writer, fields, tagged, stop, presence, array_starts(writer, fields, tagged, fresh=fresh), depth, strange)
    begin = writer.position
    at = writer.var("at", begin)
    ended = writer.var("ended", nodes.Const("bool", value=False)) if tagged.group is not None else None
    with writer.nested() as body:
        writer.position = at
        _read_field(message, ended)
        writer.expect(nodes.Compare("le", writer.position, stop), "truncated", fields.where, "a field goes beyond its message")
        writer.assign(at, writer.position)
    goes_on: nodes.Expr = nodes.Compare("lt", at, stop)
    if ended is not None:
        goes_on = nodes.Binary("and", goes_on, nodes.Compare("eq", ended, nodes.Const("bool", value=False)))
    invariant = [nodes.Compare("ge", at, begin), nodes.Compare("le", at, stop)]
    if stop != END:  # else the proof must go through all messages around this one
        invariant.append(nodes.Compare("le", stop, END))
    for path, start in message.starts.items():
        invariant += [nodes.Compare("ge", start, index(0)), nodes.Compare("le", start, nodes.Used(lane_of(fields, path)))]
    writer.emit(nodes.While(goes_on, block(body), tuple(invariant), at))
    writer.position = at
    if ended is not None:
        writer.expect(ended, "truncated", fields.where, "the group has no end")
    _finish(message)


def _finish(message: Message) -> None:
    """Write down what was kept in locals, and see that what must come has come."""
    writer, fields, row = message.writer, message.fields, row_of(message.fields)
    for path, start in message.starts.items():
        cell = fields.find(path)
        fields.set_span(cell, start, nodes.Binary("sub", nodes.Used(span_of(cell).lane), start))
    for number, word in enumerate(message.presence):
        writer.emit(nodes.SetField(fields.cell.place(row.offset + 8 * number), word))
    for name in message.tagged.required:
        bit = row.member(name).presence
        assert bit is not None
        mask = nodes.Const("u64", 1 << bit % 64)
        present = nodes.Compare("ne", nodes.Binary("and", message.presence[bit // 64], mask), nodes.Const("u64", 0))
        writer.expect(present, "missing", fields.where.member(name), "a required field did not come")


def _read_field(message: Message, ended: nodes.Local | None) -> None:
    writer, group = message.writer, message.tagged.group
    begin = writer.position
    tag = writer.let("tag", nodes.Convert("i64", read_tag(writer, message.fields.where)))
    cases = list(_known_fields(message))
    if ended is not None and group is not None:
        cases.append(Case(group << 3 | END_GROUP, partial(writer.assign, ended, nodes.Const("bool", value=True))))

    def unknown() -> None:
        skip_unknown(writer, message.fields, tag, message.stop)
        _keep(message, begin)

    read_cases(writer, tag, cases, unknown, message.fields.where, message.stop)


def _known_fields(message: Message) -> Iterator[Case]:
    """A case for each way in which a field can be written, and what is likely to follow: another element, or the next field."""
    entries = message.tagged.entries
    # The proof does not follow where groups and recursive messages end.
    guesses = message.tagged.group is None and message.depth == index(0)
    for entry, following in zip(entries, (*entries[1:], None), strict=False):
        next_tag = _likely_tag(message.tagged, following)
        for wire in _wires(entry):
            tag, packed = entry.number << 3 | wire, wire == 2 and entry.wire != 2
            guess = next_tag if packed or entry.label == "single" else tag
            yield Case(tag, partial(_read_entry, message, entry, packed=packed), guess if guesses else NONE, is_long=wire in (BYTES, GROUP))


def _likely_tag(tagged: Tagged, following: Entry | None) -> int:
    """The tag of the next field, if it must come."""
    if following is None or following.path[-1] not in tagged.required:
        return NONE
    return following.number << 3 | (2 if following.label == "packed" else following.wire)


def _wires(entry: Entry) -> tuple[int, ...]:
    """Numbers of an array may come one by one or packed, whatever the schema prefers."""
    return (entry.wire, 2) if entry.label != "single" and entry.wire in (0, 1, 5) else (entry.wire,)


def _read_entry(message: Message, entry: Entry, *, packed: bool) -> None:
    if packed:
        _read_packed(message, entry)
    elif entry.label == "single":
        _read_single(message, entry)
    else:
        _read_element(message, entry)


def _keep(message: Message, begin: nodes.Expr, tag: bytes = b"") -> None:
    """Append what was read since then to the unknown fields of the message, behind a tag if it had none of its own."""
    unknown = row_of(message.fields).unknown
    if unknown is None:
        return
    writer = message.writer
    size = writer.let("size_of_field", nodes.Binary("sub", writer.position, begin))
    writer.expect(
        nodes.Compare("ge", size, index(0)), "length", message.fields.where, "a field goes beyond its message"
    )  # said for the proof
    start = message.fields.reserve(unknown.lane, add(size, len(tag)))
    for number, byte in enumerate(tag):
        writer.emit(nodes.SetField(nodes.Place(unknown.lane, add(start, number)), nodes.Const("u8", byte)))
    writer.emit(nodes.Copy(nodes.Place(unknown.lane, add(start, len(tag))), nodes.Wire(begin), size))


# --- one value ---------------------------------------------------------------------------------------------------------------


def _read_single(message: Message, entry: Entry) -> None:
    writer, fields, where = message.writer, message.fields, message.fields.shown(entry.path)
    begin = writer.position
    match entry.value:
        case Number(_, scalar, order):
            value = writer.let("value", writer.load(scalar_name(scalar), where, order))
            mark(message, entry.path)
            set_number(fields, entry.path, value)
        case Varint() as varint:
            value = _varint_value(message, varint, fields.find(entry.path).slot, where)
            with writer.nested() as known:
                mark(message, entry.path)
                set_number(fields, entry.path, value)
            _if_allowed(message, entry, value, known, begin)
        case Blob(_, _, text, _):
            start, size = _read_bytes(message, fields, span_of(fields.find(entry.path)), where, text=text)
            mark(message, entry.path)
            fields.set_span(fields.find(entry.path), start, size)
        case Tagged() as tagged:
            stop = _stop(message, tagged, where)
            clear_other_case(message, entry.path)
            mark(message, entry.path)
            inner = HolderFields(writer, fields.layout, fields.find(entry.path), where, fields.borrow)
            read_message(writer, inner, tagged, stop, fresh=False, depth=message.depth)
        case Recursion() as recursion:
            from rosetta_jit.lowering.codec.work_list import read_recursive

            clear_other_case(message, entry.path)
            mark(message, entry.path)
            read_recursive(message, entry, recursion, where)
        case _:
            raise AssertionError(entry)


def _varint_value(
    message: Message, varint: Varint, slot: Slot, where: Where, read: Callable[[Writer, Where], nodes.Local] = read_varint
) -> nodes.Local:
    scalar = slot.scalar if isinstance(slot, NumberSlot) else "u64"
    value = from_varint(varint, read(message.writer, where), scalar)
    return message.writer.let("value", value if scalar == "bool" else converted(value, scalar))


def _if_allowed(message: Message, entry: Entry, value: nodes.Local, known: list[nodes.Stmt], begin: nodes.Expr) -> None:
    """A number that a closed enum does not name counts as an unknown field. It begins behind its tag."""
    writer = message.writer
    if not entry.allowed:
        writer.emit(*known)
        return
    number = value if value.type == "i64" else nodes.Convert("i64", value)
    low, high = entry.allowed[0], entry.allowed[-1]
    if high - low + 1 == len(entry.allowed):
        allowed: nodes.Expr = nodes.Binary("and", nodes.Compare("ge", number, index(low)), nodes.Compare("le", number, index(high)))
    else:
        allowed = nodes.Compare("eq", number, index(low))
        for each in entry.allowed[1:]:
            allowed = nodes.Binary("or", allowed, nodes.Compare("eq", number, index(each)))
    with writer.nested() as unknown:
        if message.strange is None:
            _keep(message, begin, varint_bytes(entry.number << 3))
        else:
            writer.assign(message.strange, nodes.Const("bool", value=True))
    writer.emit(nodes.If(allowed, block(known), block(unknown)))


def _read_bytes(message: Message, fields: HolderFields, span: Span, where: Where, *, text: bool) -> tuple[nodes.Expr, nodes.Expr]:
    """Bytes of a string or bytes field, taken into their lane or left where they are; start and count as a span has them."""
    writer = message.writer
    size = read_length(writer, where, message.stop)
    at = writer.position
    if text:
        writer.expect(nodes.IsText(nodes.Wire(at), size), "text", where, "not valid UTF-8")
    writer.advance(size)
    left = writer.left_in_message(span.lane, size) if fields.borrow and (writer.texts_stay or not text) else None
    if left is not None:
        return at, left
    start = fields.reserve(span.lane, size)
    writer.emit(nodes.Copy(nodes.Place(span.lane, start), nodes.Wire(at), size))
    return start, size


def _stop(message: Message, tagged: Tagged, where: Where) -> nodes.Expr:
    """Where an inner message stops: behind its length, or with what is around it if it is a group."""
    if tagged.group is not None:
        message.writer.expect(
            nodes.Compare("le", message.writer.position, message.stop), "truncated", where, "the group goes beyond its message"
        )
        return message.stop
    size = read_length(message.writer, where, message.stop)
    return message.writer.let("stop", nodes.Binary("add", message.writer.position, size))


# --- arrays ------------------------------------------------------------------------------------------------------------------


def _read_element(message: Message, entry: Entry) -> None:
    """One more element at the end of its lane."""
    writer, fields, begin = message.writer, message.fields, message.writer.position
    lane = lane_of(fields, entry.path)
    where = fields.shown(entry.path).element(nodes.Binary("sub", nodes.Used(lane), message.starts[entry.path]))
    match entry.value:
        case Number(_, scalar, order):
            value = writer.let("value", writer.load(scalar_name(scalar), where, order))
            _append(message, lane, value)
            if has_runs(entry, message.tagged):
                read_run(writer, fields, lane, entry.value, entry.number << 3 | entry.wire, message.stop)
        case Varint() as varint:
            value = _varint_value(message, varint, fields.layout.lanes[lane].element, where, read_element)
            with writer.nested() as known:
                _append(message, lane, value)
            _if_allowed(message, entry, value, known, begin)
            if has_runs_of_varints(entry, message.tagged):
                read_run_of_varints(writer, fields, lane, varint, entry.number << 3, begin, message.stop)
        case Blob(_, _, text, _):
            span = fields.layout.lanes[lane].element
            assert isinstance(span, Span)
            start, size = _read_bytes(message, fields, span, where, text=text)
            row = fields.reserve(lane, index(1))
            fields.set_span(Cell(lane, row, span), start, size)
        case Tagged(whole=True) as tagged:
            _read_whole(message, entry, tagged, where)
        case Tagged() as tagged:
            stop = _stop(message, tagged, where)
            row = fields.reserve(lane, index(1))
            writer.emit(nodes.Fill(nodes.Place(lane, row), index(fields.layout.lanes[lane].stride)))
            # Its number is that of the last row now. Of the locals that say it, all are in use anyway: one more would cost calls 7 %.
            inside = fields.shown(entry.path).element(nodes.Binary("sub", nodes.Used(lane), add(message.starts[entry.path], 1)))
            inner = HolderFields(writer, fields.layout, Cell(lane, row, fields.layout.lanes[lane].element), inside, fields.borrow)
            read_message(writer, inner, tagged, stop, fresh=True, depth=message.depth)
        case Recursion() as recursion:
            from rosetta_jit.lowering.codec.work_list import read_recursive

            read_recursive(message, entry, recursion, where)
        case _:
            raise AssertionError(entry)


def _read_whole(message: Message, entry: Entry, tagged: Tagged, where: Where) -> None:
    """An entry of a map, whose row is in use when it was read: one with a value that is not allowed counts as an unknown field."""
    writer, fields, begin = message.writer, message.fields, message.writer.position
    lane = lane_of(fields, entry.path)
    element = fields.layout.lanes[lane]
    stop = _stop(message, tagged, where)
    writer.emit(nodes.Reserve(lane, index(1)))
    row = writer.let("row", nodes.Used(lane))
    writer.emit(nodes.Fill(nodes.Place(lane, row), index(element.stride)))
    strange = writer.var("strange", nodes.Const("bool", value=False))
    inner = HolderFields(writer, fields.layout, Cell(lane, row, element.element), where, fields.borrow)
    read_message(writer, inner, tagged, stop, fresh=True, depth=message.depth, strange=strange)
    with writer.nested() as unknown:
        _keep(message, begin, varint_bytes(entry.number << 3 | BYTES))
    writer.emit(nodes.If(strange, block(unknown), (nodes.Advance(lane, index(1)),)))


def _append(message: Message, lane: int, value: nodes.Local) -> None:
    element = message.fields.layout.lanes[lane].element
    assert isinstance(element, NumberSlot)
    message.writer.emit(
        nodes.Reserve(lane, index(1)),
        nodes.SetField(nodes.Place(lane, nodes.Used(lane)), converted(value, element.scalar)),
        nodes.Advance(lane, index(1)),
    )


def _read_packed(message: Message, entry: Entry) -> None:
    """Numbers without tags, as many as fill the length."""
    writer, fields = message.writer, message.fields
    where, lane = fields.shown(entry.path), lane_of(fields, entry.path)
    size = read_length(writer, where, message.stop)
    match entry.value:
        case Number(_, scalar, order):
            read_fixed(writer, fields, lane, size, scalar, order, where)
        case Varint() as varint:
            _read_packed_varints(message, entry, varint, lane, size)
        case _:
            raise AssertionError(entry)


def _read_packed_varints(message: Message, entry: Entry, varint: Varint, lane: int, size: nodes.Local) -> None:
    writer, fields = message.writer, message.fields
    where = fields.shown(entry.path)
    stop = writer.let("stop", nodes.Binary("add", writer.position, size))
    at = writer.var("at", writer.position)

    def read_one() -> None:
        writer.position = at
        value = _varint_value(message, varint, fields.layout.lanes[lane].element, where, read_packed)
        with writer.nested() as known:
            _append(message, lane, value)
        _if_allowed(message, entry, value, known, at)
        writer.assign(at, writer.position)

    with writer.nested() as body:
        if reads_several(entry, message.tagged):
            read_varints(writer, fields, varint, lane, stop, at, read_one)
        else:
            read_one()
        writer.position = at
        writer.expect(nodes.Compare("le", at, stop), "truncated", where, "the last number goes beyond the array")
    start = message.starts[entry.path]
    invariant = (nodes.Compare("ge", at, BEGIN), nodes.Compare("le", at, stop), nodes.Compare("le", start, nodes.Used(lane)))
    writer.emit(nodes.While(nodes.Compare("lt", at, stop), block(body), invariant, at))
    writer.position = at


# --- where things are -----------------------------------------------------------------------------------------------------------
