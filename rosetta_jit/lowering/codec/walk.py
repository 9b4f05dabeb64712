"""The walk over a codec: one for decoding, encoding and sizing. What is structural is the same for all of them.

Direction is known to the leaves (`rosetta_jit.lowering.codec.leaves`), and here where elements are opened or found, and cases chosen.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel.nodes import Assign, Binary, Block, Compare, Const, Convert, Expect, Expr, For, If, Let, Local, Switch, While
from rosetta_jit.kernel.rewrite import names_read
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.codec import leaves
from rosetta_jit.lowering.codec.ending import refuse_other_length, refuse_tried
from rosetta_jit.lowering.codec.fields import Elements, Fields, scalar_name
from rosetta_jit.lowering.limits import MAX_SIZE
from rosetta_jit.lowering.writer import Where, Writer, block, integer
from rosetta_jit.startup.late import late
from rosetta_jit.wire import codec as wire
from rosetta_jit.wire.size import fixed_size, minimum_size

if TYPE_CHECKING:
    from rosetta_jit.lowering.codec import counts, wire_fields, xcdr1_members, xcdr2_members
else:
    counts, wire_fields = late("rosetta_jit.lowering.codec", "counts", "wire_fields")
    xcdr1_members, xcdr2_members = late("rosetta_jit.lowering.codec", "xcdr1_members", "xcdr2_members")

EMPTY_ELEMENTS = 1 << 16
"""How many elements that take no bytes a message may have, whatever its own size."""


def walk(codec: wire.Codec, fields: Fields, writer: Writer) -> None:
    """Read or write what a codec describes, at the current position."""
    match codec:
        case wire.Seq(items):
            for item in items:
                walk(item, fields, writer)
        case (
            wire.Number()
            | wire.Unsent()
            | wire.Table()
            | wire.Constant()
            | wire.Computed()
            | wire.Padding()
            | wire.Align()
            | wire.Blob()
            | wire.Utf16()
        ):
            leaves.leaf(codec, fields, writer)
        case wire.Repeat():
            _repeat(writer, fields, codec)
        case wire.Choice():
            _choice(writer, fields, codec)
        case wire.Cases():
            _cases(writer, fields, codec)
        case wire.Maybe():
            _maybe(writer, fields, codec)
        case wire.Delimited():
            _delimited(writer, fields, codec)
        case wire.Members():
            xcdr2_members.members(codec, fields, writer, walk)
        case wire.Parameter():
            xcdr1_members.parameter(codec, fields, writer, walk)
        case wire.Parameters():
            xcdr1_members.parameters(codec, fields, writer, walk)
        case wire.Tagged() | wire.Varint() | wire.Recursion():
            raise AssertionError(codec)  # `tagged`, `recursion` and `descent` read and write these
        case _:
            assert_never(codec)


def _repeat(writer: Writer, fields: Fields, repeat: wire.Repeat) -> None:
    elements, count = begin_elements(writer, fields, repeat)
    where, size = fields.shown(repeat.path), fixed_size(repeat.item)
    if size is None:
        _each_in_turn(writer, repeat.item, elements, count)
    else:
        _each_at_its_place(writer, repeat.item, elements, count, size, where)


def begin_elements(writer: Writer, fields: Fields, repeat: wire.Repeat) -> tuple[Elements, Expr]:
    """The count and what stands before the first element; the elements, and how many there are."""
    where = fields.shown(repeat.path)
    if writer.direction == "decode":
        total = counts.read_count(writer, fields, repeat.path, repeat.count, "count", least=repeat.extra)
        count = writer.let("elements", add(total, -repeat.extra)) if repeat.extra else total
        walk(wire.Seq(repeat.head), fields, writer)
        _align_first(writer, repeat, count)
        _plausible(writer, repeat, count, where)
        return fields.open(repeat.path, count), count
    fixed = repeat.count.value - repeat.extra if isinstance(repeat.count.value, int) else None
    stored = fields.stored(repeat.path, fixed)
    counts.write_count(writer, fields, repeat.count, stored.size, where, extra=repeat.extra)
    walk(wire.Seq(repeat.head), fields, writer)
    _align_first(writer, repeat, stored.size)
    return fields.elements(repeat.path, stored), stored.size


def _align_first(writer: Writer, repeat: wire.Repeat, count: Expr) -> None:
    if repeat.align > 1:
        leaves.align(writer, repeat.align, Compare("gt", count, index(0)))


def _plausible(writer: Writer, repeat: wire.Repeat, count: Expr, where: Where) -> None:
    """A message has at least as many bytes as its elements need, so that a count alone cannot take much memory."""
    if isinstance(count, Const):
        return
    least = minimum_size(repeat.item)
    if least:
        writer.expect(Compare("le", count, index(MAX_SIZE // least)), "count", where, "too many elements")
        writer.require(mul(count, least), where, "the message ends before its elements")
    else:
        writer.expect(Compare("le", count, index(EMPTY_ELEMENTS)), "count", where, "too many elements that take no bytes")


def _each_at_its_place(writer: Writer, item: wire.Codec, elements: Elements, count: Expr, size: int, where: Where) -> None:
    """Elements of one size: each position follows from the number."""
    writer.expect(Compare("le", count, index(MAX_SIZE // max(size, 1))), "count", where, "too many elements")
    total = mul(count, size)
    writer.require(total, where)
    if writer.direction != "size":
        first = writer.position
        placed = elements.place(item, first, size)
        number = Local("i64", writer.fresh("i"))
        with writer.nested() as body:
            writer.position = writer.let("item", Binary("add", first, mul(number, size)))
            with writer.whole():
                walk(item, placed.at(number), writer)
        writer.emit(For(number.name, count, block(body)))
    writer.advance(total)


def _each_in_turn(writer: Writer, item: wire.Codec, elements: Elements, count: Expr) -> None:
    """Elements of their own sizes, one behind the other."""
    number, at = writer.var("i", index(0)), writer.cursor()
    with writer.nested() as body:
        writer.position = at
        with writer.whole():
            walk(item, elements.at(number), writer)
        writer.settle()
        writer.emit(Assign(at.name, writer.position), Assign(number.name, add(number, 1)))
    invariant = (Compare("ge", number, index(0)), *writer.position_invariant(at))
    writer.emit(While(Compare("lt", number, count), block(body), invariant, number))
    writer.position = at


def _choice(writer: Writer, fields: Fields, choice: wire.Choice) -> None:
    if writer.direction != "decode":
        _write_choice(writer, fields, choice)
        return
    where, scalar, begin = fields.shown(choice.path), scalar_name(choice.scalar), writer.position
    code = writer.let("code", integer(writer.load(scalar, where, choice.order)))
    for value, codec in choice.alternatives[: choice.tried]:
        writer.emit(If(Compare("eq", code, index(value)), _tried(writer, fields.where, codec)))
    known = ", ".join(str(value) for value, _ in choice.alternatives)
    unknown = writer.failure("tag", where, f"must be one of {known}", at=begin)
    remaining = choice.alternatives[choice.tried :]
    if len(remaining) == 1:
        writer.emit(Expect(Compare("eq", code, index(remaining[0][0])), unknown))
        walk(remaining[0][1], fields, writer)
        return
    fields.branch(choice)
    at = writer.var("next", writer.position)
    cases = tuple((value, _alternative(writer, fields, codec, at)) for value, codec in remaining)
    writer.emit(Switch(code, cases, (Expect(Const("bool", value=False), unknown),)))
    writer.position = at


def _tried(writer: Writer, where: Where, codec: wire.Codec) -> Block:
    """What an earlier attempt has failed at: it is read for what is wrong with it, where that attempt has not said so."""
    with writer.nested() as body:
        if fixed_size(codec) is None:
            refuse_tried(writer)
        else:
            with writer.whole():
                walk(codec, wire_fields.WireFields(writer, wire_fields.Found(), where=where, element=True), writer)
            refuse_other_length(writer)
    read = names_read(block(body))
    return tuple(stmt for stmt in body if not isinstance(stmt, Let) or stmt.name in read)


def _write_choice(writer: Writer, fields: Fields, choice: wire.Choice) -> None:
    where = fields.shown(choice.path)
    if choice.labels:
        _write_labelled(writer, fields, choice, where)
        return
    if not choice.when_empty:
        _written_alternative(writer, fields, choice, 0, where)
        return
    fields.branch(choice)
    at = writer.var("next", writer.position)
    empty = Compare("eq", fields.stored(choice.path).size, index(0))
    branches: list[Block] = []
    for number in (choice.when_empty, 0):
        with writer.nested() as body:
            _written_alternative(writer, fields, choice, number, where)
            writer.emit(Assign(at.name, writer.position))
        branches.append(block(body))
    writer.emit(If(empty, *branches))
    writer.position = at


def _write_labelled(writer: Writer, fields: Fields, choice: wire.Choice, where: Where) -> None:
    label = integer(_got(fields, choice.path))
    fields.branch(choice)
    at = writer.var("next", writer.position)
    blocks: list[Block] = []
    for number in range(len(choice.alternatives)):
        with writer.nested() as body:
            _written_alternative(writer, fields, choice, number, where)
            writer.emit(Assign(at.name, writer.position))
        blocks.append(block(body))
    *known, other = blocks
    writer.emit(Switch(writer.let("label", label), tuple(zip(choice.labels, known, strict=True)), other))
    writer.position = at


def _written_alternative(writer: Writer, fields: Fields, choice: wire.Choice, number: int, where: Where) -> None:
    value, codec = choice.alternatives[number]
    writer.store(Const(scalar_name(choice.scalar), value), where, choice.order)
    walk(codec, fields, writer)


def _alternative(writer: Writer, fields: Fields, codec: wire.Codec, at: Local) -> Block:
    with writer.nested() as body:
        walk(codec, fields, writer)
        writer.emit(Assign(at.name, writer.position))
    return block(body)


def _cases(writer: Writer, fields: Fields, cases: wire.Cases) -> None:
    walk(cases.discriminator, fields, writer)
    at = writer.var("next", writer.position)
    switch_cases(writer, fields, cases, lambda codec: (walk(codec, fields, writer), writer.assign(at, writer.position)))
    writer.position = at


def switch_cases(writer: Writer, fields: Fields, cases: wire.Cases, body: Callable[[wire.Codec], object]) -> None:
    """What is done in the case that the discriminator names, after it has come; where it names none, with an empty codec."""
    value = _first_label(writer, cases, integer(_got(fields, discriminator_path(cases.discriminator))))
    blocks: list[tuple[int, Block]] = []
    default: Block | None = None
    for number, (labels, codec) in enumerate(cases.cases):
        with writer.nested() as statements:
            fields.choose(cases.path, number + 1)
            body(codec)
        if number == cases.default:
            default = block(statements)
        else:
            blocks.append((labels[0], block(statements)))
    if default is None:
        with writer.nested() as statements:
            fields.choose(cases.path, 0)
            body(wire.Seq(()))
        default = block(statements)
    writer.emit(Switch(value, tuple(blocks), default))


def _first_label(writer: Writer, cases: wire.Cases, value: Expr) -> Expr:
    """The first label of the case that a value names, so that each case is written once."""
    value = writer.let("label", value)
    further = [(other, labels[0]) for number, (labels, _) in enumerate(cases.cases) for other in labels[1:] if number != cases.default]
    if not further:
        return value
    first = writer.var("case", value)
    writer.emit(Switch(value, tuple((other, (Assign(first.name, index(label)),)) for other, label in further), ()))
    return first


def discriminator_path(codec: wire.Codec) -> tuple[str, ...]:
    """The field that a discriminator carries."""
    match codec:
        case wire.Number(path) | wire.Table(path) | wire.Choice(path):
            return path
        case wire.Parameter(member):
            return member.path
        case wire.Seq(items):
            return discriminator_path(items[-1])
        case _:
            raise AssertionError(codec)


def _maybe(writer: Writer, fields: Fields, maybe: wire.Maybe) -> None:
    at = writer.var("next", writer.position)
    if_present(writer, fields, maybe, lambda codec: (walk(codec, fields, writer), writer.assign(at, writer.position)))
    writer.position = at


def if_present(writer: Writer, fields: Fields, maybe: wire.Maybe, body: Callable[[wire.Codec], object]) -> None:
    """The flag, and what is done if the field is there; otherwise with an empty codec."""
    where, begin = fields.shown(maybe.path), writer.position
    if writer.direction == "decode":
        flag = writer.let("flag", writer.load("u8", where))
        writer.expect(Compare("le", flag, Const("u8", 1)), "constant", where, "must be 0 or 1", at=begin)
        present: Expr = Compare("ne", flag, Const("u8", 0))
    else:
        present = writer.let("present", fields.present(maybe.path))
        writer.store(Convert("u8", present), where)
    blocks: list[Block] = []
    for codec in (maybe.value, wire.Seq(())):
        with writer.nested() as statements:
            if writer.direction == "decode" and codec is maybe.value:
                fields.appear(maybe.path)
            body(codec)
        blocks.append(block(statements))
    writer.emit(If(present, blocks[0], blocks[1]))


def _delimited(writer: Writer, fields: Fields, delimited: wire.Delimited) -> None:
    where, begin = fields.shown(delimited.path), writer.position
    if writer.direction == "decode":
        size = writer.let("size", integer(writer.load("u32", where, delimited.order)))
        writer.require(size, where)
        stop = writer.let("stop", Binary("add", writer.position, size))
        walk(delimited.value, fields, writer)
        writer.expect(Compare("eq", writer.position, stop), "length", where, "its content is not as long as it says", at=begin)
        return
    writer.require(4, where, "no room for the message")
    writer.advance(4)
    inside = writer.let("inside", writer.position)
    walk(delimited.value, fields, writer)
    xcdr2_members.store_size(writer, begin, inside, where, delimited.order)


def _got(fields: Fields, path: tuple[str, ...]) -> Expr:
    """A number that tells what follows; that of an element is not known where rules write it in its place."""
    value = fields.get(path)
    assert value is not None, path
    return value
