"""The walk over a codec: one for decoding, encoding and sizing. What is structural is the same for all of them.

Direction is known to the leaves alone: a number is loaded, stored, or counted; a constant is expected, stored, or counted; a
count is read and checked, or written.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel.ir import (
    WIDTH,
    Assign,
    Binary,
    Compare,
    Const,
    Convert,
    Expect,
    Expr,
    For,
    If,
    IsText,
    Load,
    Local,
    Scalar,
    Select,
    Store,
    Switch,
    While,
    Wire,
    add,
    index,
    mul,
    type_of,
)
from rosetta_jit.lowering.computed import evaluate
from rosetta_jit.lowering.fields import scalar_name
from rosetta_jit.lowering.writer import MAX_SIZE, Where, Writer, block, integer
from rosetta_jit.wire.codec import (
    Blob,
    Choice,
    Codec,
    Computed,
    Constant,
    Count,
    Number,
    Padding,
    Recursion,
    Repeat,
    Seq,
    Table,
    Tagged,
    Varint,
)
from rosetta_jit.wire.size import fixed_size, minimum_size

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rosetta_jit.kernel.ir import Block
    from rosetta_jit.lowering.fields import Elements, Fields
    from rosetta_jit.model import expr

LIMITS = {"i8": 1 << 7, "u8": 1 << 8, "i16": 1 << 15, "u16": 1 << 16, "i32": 1 << 31, "u32": 1 << 32}
"""The first count that a number on the wire cannot carry."""


def walk(codec: Codec, fields: Fields, writer: Writer) -> None:
    """Read or write what a codec describes, at the current position."""
    match codec:
        case Seq(items):
            for item in items:
                walk(item, fields, writer)
        case Number(path, scalar, order):
            _number(writer, fields, path, scalar_name(scalar), order)
        case Table():
            _table(writer, fields, codec)
        case Constant(_, bytes(value)):
            _text_constant(writer, fields, codec.path, value)
        case Constant():
            _number_constant(writer, fields, codec)
        case Computed(path, scalar, value, order):
            _computed(writer, fields, path, scalar_name(scalar), value, order)
        case Padding(scalar, value, order):
            _padding(writer, fields.where, scalar_name(scalar), value, order)
        case Blob():
            _blob(writer, fields, codec)
        case Repeat():
            _repeat(writer, fields, codec)
        case Choice():
            _choice(writer, fields, codec)
        case Tagged() | Varint() | Recursion():
            raise AssertionError(codec)  # `tagged` and `recursion` read and write these
        case _:
            assert_never(codec)


# --- leaves: the only place that asks for the direction --------------------------------------------------------------------


def _number(writer: Writer, fields: Fields, path: tuple[str, ...], scalar: Scalar, order: str) -> None:
    where = fields.where.members(path)
    if writer.direction == "decode":
        fields.put(path, writer.load(scalar, where, order))
        return
    value = fields.get(path) if writer.direction == "encode" else None
    if value is None:
        writer.require(WIDTH[scalar], where, "no room for the message")
        writer.advance(WIDTH[scalar])
    else:
        writer.store(_as(scalar, value), where, order)


def _table(writer: Writer, fields: Fields, table: Table) -> None:
    where, scalar = fields.where.members(table.path), scalar_name(table.scalar)
    detail = "not one of " + ", ".join(str(wire) for wire, _ in table.pairs)
    if writer.direction == "decode":
        at = writer.position
        wire = writer.let("code", integer(writer.load(scalar, where, table.order)))
        pairs: list[tuple[Expr, int]] = [(Compare("eq", wire, index(number)), value) for number, value in table.pairs]
        writer.expect(_any(test for test, _ in pairs), "constant", where, detail, at=at)
        fields.put(table.path, _select(pairs))
        return
    value = fields.get(table.path) if writer.direction == "encode" else None
    if value is None:
        writer.require(WIDTH[scalar], where)
        writer.advance(WIDTH[scalar])
        return
    known = writer.let("code", integer(value))
    written: list[tuple[Expr, int]] = [(Compare("eq", known, index(value)), number) for number, value in table.pairs]
    writer.expect(_any(test for test, _ in written), "range", where, "the wire has no word for this value")
    writer.store(_as(scalar, _select(written)), where, table.order)


def _number_constant(writer: Writer, fields: Fields, constant: Constant) -> None:
    where = fields.where.members(constant.path)
    scalar = scalar_name(constant.scalar)
    value = Const(scalar, constant.value if isinstance(constant.value, int | float) else 0)
    if writer.direction == "decode":
        at = writer.position
        found = writer.load(scalar, where, constant.order)
        writer.expect(Compare("eq", found, value), constant.kind, where, f"must be {constant.value}", at=at)
        if constant.kind == "constant" and constant.path:
            fields.put(constant.path, value)
    else:
        writer.store(value, where, constant.order)


def _text_constant(writer: Writer, fields: Fields, path: tuple[str, ...], value: bytes) -> None:
    where = fields.where.members(path)
    writer.require(len(value), where)
    for offset, number, scalar in _words(value):
        at = add(writer.position, offset)
        if writer.direction == "decode":
            found = Compare("eq", Load(scalar, at), Const(scalar, number))
            writer.expect(found, "constant", where, f"must be {value!r}", at=at)
        elif writer.direction == "encode":
            writer.emit(Store(at, Const(scalar, number)))
    if writer.direction == "decode" and path:
        fields.put_bytes(path, writer.position, index(len(value)))
    writer.advance(len(value))


def _computed(writer: Writer, fields: Fields, path: tuple[str, ...], scalar: Scalar, value: expr.Expr, order: str) -> None:
    where = fields.where.members(path)
    if writer.direction == "size":
        writer.advance(WIDTH[scalar])
        return
    if writer.direction == "decode":
        fields.put(path, writer.load(scalar, where, order))
        writer.deferred.append(lambda: _agrees(writer, fields, fields.get(path), value, where, "constant"))
    else:
        expected = evaluate(value, fields, writer, where)
        _in_range(writer, where, expected, scalar)
        writer.store(_as(scalar, expected), where, order)


def _agrees(writer: Writer, fields: Fields, found: Expr | None, value: expr.Expr, where: Where, kind: str) -> None:
    """Checked when the message has been read, since any of its fields may determine the value."""
    assert found is not None
    known = writer.let("found", integer(found))
    expected = evaluate(value, fields, writer, where)
    writer.expect(Compare("eq", known, expected), kind, where, "must agree with the fields that determine it")


def _padding(writer: Writer, where: Where, scalar: Scalar, value: int, order: str) -> None:
    if writer.direction == "decode":
        writer.require(WIDTH[scalar], where)
        writer.advance(WIDTH[scalar])
    else:
        writer.store(Const(scalar, value), where, order)


def _blob(writer: Writer, fields: Fields, blob: Blob) -> None:
    where = fields.where.members(blob.path)
    extra = int(blob.terminated)
    if writer.direction == "decode":
        total = read_count(writer, fields, blob.path, blob.count, "length", least=extra)
        writer.require(total, where)
        size = _without_terminator(writer, total, where) if blob.terminated else total
        if blob.text:
            writer.expect(IsText(Wire(writer.position), size), "text", where, "not valid UTF-8")
        fields.put_bytes(blob.path, writer.position, size)
        writer.advance(total)
        return
    stored = fields.stored(blob.path)
    write_count(writer, blob.count, add(stored.size, extra), where)
    writer.require(stored.size, where, "no room for the message")
    if writer.direction == "encode":
        fields.copy_bytes(blob.path, stored)
    writer.advance(stored.size)
    if blob.terminated:
        writer.store(Const("u8", 0), where)


def _without_terminator(writer: Writer, total: Expr, where: Where) -> Expr:
    last = Load("u8", Binary("sub", Binary("add", writer.position, total), index(1)))
    writer.expect(Compare("eq", last, Const("u8", 0)), "constant", where, "a string must end with NUL")
    return writer.let("length", Binary("sub", total, index(1)))


def read_count(writer: Writer, fields: Fields, path: tuple[str, ...], count: Count, kind: str, *, least: int = 0) -> Expr:
    """A count that has come: not negative, and what the schema says it must be."""
    where, scalar, at = fields.where.members(path), scalar_name(count.scalar), writer.position
    found = writer.let("count", integer(writer.load(scalar, where, count.order)))
    if isinstance(count.value, int):
        writer.expect(Compare("eq", found, index(count.value)), kind, where, f"must be {count.value}", at=at)
        return index(count.value)
    rule = f"must be at least {least}" if least else "must not be negative"
    writer.expect(Compare("ge", found, index(least)), kind, where, rule, at=at)
    value = count.value
    if value is not None:
        writer.deferred.append(lambda: _agrees(writer, fields, fields.stored(path).size, value, where, kind))
    return found


def write_count(writer: Writer, count: Count, value: Expr, where: Where) -> None:
    """A count to be written; one that the schema fixes must be that one."""
    if isinstance(count.value, int):
        writer.expect(Compare("eq", value, index(count.value)), "count", where, f"must be {count.value}")
    scalar = scalar_name(count.scalar)
    if scalar in LIMITS:
        writer.expect(Compare("lt", value, index(LIMITS[scalar])), "range", where, "too many for the wire")
    writer.store(_as(scalar, value), where, count.order)


# --- structure: the same in every direction -------------------------------------------------------------------------------


def _repeat(writer: Writer, fields: Fields, repeat: Repeat) -> None:
    where = fields.where.members(repeat.path)
    if writer.direction == "decode":
        total = read_count(writer, fields, repeat.path, repeat.count, "count", least=repeat.extra)
        count = writer.let("elements", add(total, -repeat.extra)) if repeat.extra else total
        walk(Seq(repeat.head), fields, writer)
        least = minimum_size(repeat.item)
        writer.require(mul(count, max(least, 1)), where, "the message ends before its elements")
        elements = fields.open(repeat.path, count)
    else:
        fixed = repeat.count.value - repeat.extra if isinstance(repeat.count.value, int) else None
        stored = fields.stored(repeat.path, fixed)
        count = stored.size
        write_count(writer, repeat.count, add(count, repeat.extra), where)
        walk(Seq(repeat.head), fields, writer)
        elements = fields.elements(repeat.path, stored)
    size = fixed_size(repeat.item)
    if size is None:
        _each_in_turn(writer, repeat.item, elements, count)
    else:
        _each_at_its_place(writer, repeat.item, elements, count, size, where)


def _each_at_its_place(writer: Writer, item: Codec, elements: Elements, count: Expr, size: int, where: Where) -> None:
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


def _each_in_turn(writer: Writer, item: Codec, elements: Elements, count: Expr) -> None:
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


def _choice(writer: Writer, fields: Fields, choice: Choice) -> None:
    if writer.direction != "decode":
        _write_choice(writer, fields, choice)
        return
    where, scalar, begin = fields.where.members(choice.path), scalar_name(choice.scalar), writer.position
    code = writer.let("code", integer(writer.load(scalar, where, choice.order)))
    fields.branch(choice)
    at = writer.var("next", writer.position)
    cases = tuple((value, _alternative(writer, fields, codec, at)) for value, codec in choice.alternatives)
    with writer.nested() as default:
        known = ", ".join(str(value) for value, _ in choice.alternatives)
        failure = writer.failure("tag", where, f"must be one of {known}", at=begin)
        writer.emit(Expect(Const("bool", value=False), failure))
    writer.emit(Switch(code, cases, block(default)))
    writer.position = at


def _write_choice(writer: Writer, fields: Fields, choice: Choice) -> None:
    where = fields.where.members(choice.path)
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


def _written_alternative(writer: Writer, fields: Fields, choice: Choice, number: int, where: Where) -> None:
    value, codec = choice.alternatives[number]
    writer.store(Const(scalar_name(choice.scalar), value), where, choice.order)
    walk(codec, fields, writer)


def _alternative(writer: Writer, fields: Fields, codec: Codec, at: Local) -> Block:
    with writer.nested() as body:
        walk(codec, fields, writer)
        writer.emit(Assign(at.name, writer.position))
    return block(body)


# --- small things -----------------------------------------------------------------------------------------------------------


def _as(scalar: Scalar, value: Expr) -> Expr:
    return value if type_of(value) == scalar else Convert(scalar, value)


def _in_range(writer: Writer, where: Where, value: Expr, scalar: Scalar) -> None:
    limit = LIMITS[scalar]
    low = -limit if scalar.startswith("i") else 0
    inside = Binary("and", Compare("ge", value, index(low)), Compare("lt", value, index(limit)))
    writer.expect(inside, "range", where, "does not fit on the wire")


def _any(tests: Iterable[Expr]) -> Expr:
    result: Expr | None = None
    for test in tests:
        result = test if result is None else Binary("or", result, test)
    return result or Const("bool", value=False)


def _select(pairs: list[tuple[Expr, int]]) -> Expr:
    result: Expr = index(pairs[-1][1])
    for test, value in reversed(pairs[:-1]):
        result = Select(test, index(value), result)
    return result


def _words(value: bytes) -> list[tuple[int, int, Scalar]]:
    """Bytes as the fewest little-endian words: offset, number, type."""
    words: list[tuple[int, int, Scalar]] = []
    offset = 0
    sizes: tuple[tuple[int, Scalar], ...] = ((8, "u64"), (4, "u32"), (2, "u16"), (1, "u8"))
    while offset < len(value):
        size, scalar = next(each for each in sizes if each[0] <= len(value) - offset)
        words.append((offset, int.from_bytes(value[offset : offset + size], "little"), scalar))
        offset += size
    return words
