"""The leaves of a codec: the only place that asks for the direction.

A number is loaded, stored, or counted; a constant is expected, stored, or counted.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable
from contextlib import contextmanager
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import add, index, mul, type_of
from rosetta_jit.lowering.codec.fields import Fields, scalar_name
from rosetta_jit.lowering.writer import Where, Writer, integer
from rosetta_jit.model import expr
from rosetta_jit.startup.late import Late
from rosetta_jit.wire.codec import Align, Blob, Computed, Constant, Number, Padding, Table, Unsent, Utf16

if TYPE_CHECKING:
    from rosetta_jit.lowering.codec import counts
else:
    counts = Late("rosetta_jit.lowering.codec.counts")

Leaf = Number | Unsent | Table | Constant | Computed | Padding | Align | Blob | Utf16

SHOWN_NUMBERS = 12
"""How many numbers of a table an error lists."""


def leaf(codec: Leaf, fields: Fields, writer: Writer) -> None:
    """Read or write a leaf at the current position."""
    match codec:
        case Number():
            _number(writer, fields, codec)
        case Unsent(path, scalar):
            _unsent(writer, fields, path, scalar_name(scalar))
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
        case Align(size):
            align(writer, size)
        case Blob():
            _blob(writer, fields, codec)
        case Utf16():
            _utf16(writer, fields, codec)
        case _:
            assert_never(codec)


def _number(writer: Writer, fields: Fields, number: Number) -> None:
    where, scalar = fields.shown(number.path), scalar_name(number.scalar)
    if writer.direction == "decode":
        at, value = writer.position, writer.load(scalar, where, number.order)
        fields.put(number.path, value if number.holder_scalar is None else _fitting(writer, where, value, number.holder_scalar, at))
        return
    value = fields.get(number.path) if writer.direction == "encode" else None
    if value is None:
        writer.require(nodes.WIDTH[scalar], where, "no room for the message")
        writer.advance(nodes.WIDTH[scalar])
    else:
        fitting = value if number.holder_scalar is None else _fitting(writer, where, value, scalar, writer.position)
        writer.store(counts.as_scalar(scalar, fitting), where, number.order)


def _unsent(writer: Writer, fields: Fields, path: tuple[str, ...], scalar: nodes.Scalar) -> None:
    zero = nodes.Const(scalar, False if scalar == "bool" else 0)
    if writer.direction == "decode":
        fields.put(path, zero)
    elif writer.direction == "encode" and (value := fields.get(path)) is not None:
        same = nodes.Compare("eq", counts.as_scalar(scalar, value), zero)
        writer.expect(same, "range", fields.shown(path), "the type that is written has no such field: must be 0")


def _fitting(writer: Writer, where: Where, value: nodes.Expr, target: str, at: nodes.Expr) -> nodes.Expr:
    """An integer that another type of integer has, too."""
    low, high = (choose(ends) for choose, ends in zip((max, min), zip(bounds(type_of(value)), bounds(target), strict=True), strict=True))
    known = writer.let("number", integer(value))
    fits = nodes.Binary("and", nodes.Compare("ge", known, index(low)), nodes.Compare("le", known, index(min(high, (1 << 63) - 1))))
    writer.expect(fits, "range", where, f"does not fit {target.replace('i', 'int').replace('u', 'uint')}", at=at)
    return known


def bounds(scalar: str) -> tuple[int, int]:
    """The least and the greatest value of a type of integer, by its name in kernels."""
    bits = int(scalar[1:])
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if scalar[0] == "i" else (0, (1 << bits) - 1)


def _table(writer: Writer, fields: Fields, table: Table) -> None:
    if table.scalar is None:
        _implied(writer, fields, table)
        return
    where, scalar = fields.shown(table.path), scalar_name(table.scalar)
    if writer.direction == "decode":
        at = writer.position
        wire = writer.let("code", integer(writer.load(scalar, where, table.order)))
        known, value = _translated(wire, list(table.pairs))
        writer.expect(known, "constant", where, f"not one of {_numbers(table)}", at=at)
        fields.put(table.path, value)
        return
    value = fields.get(table.path) if writer.direction == "encode" else None
    if value is None:
        writer.require(nodes.WIDTH[scalar], where)
        writer.advance(nodes.WIDTH[scalar])
        return
    known, wire = _translated(writer.let("code", integer(value)), [(value, number) for number, value in table.pairs])
    writer.expect(known, "range", where, "the wire has no word for this value")
    writer.store(counts.as_scalar(scalar, wire), where, table.order)


def _implied(writer: Writer, fields: Fields, table: Table) -> None:
    """A value that takes no bytes. What chooses this codec when encoding has looked at it."""
    if writer.direction == "decode":
        fields.put(table.path, index(table.pairs[0][1]))


def _translated(word: nodes.Expr, pairs: list[tuple[int, int]]) -> tuple[nodes.Expr, nodes.Expr]:
    """Whether a table has a word, and what it stands for. A run of numbers that stand for themselves needs no table."""
    words = sorted(number for number, _ in pairs)
    if all(number == value for number, value in pairs) and words == list(range(words[0], words[-1] + 1)):
        inside = nodes.Binary("and", nodes.Compare("ge", word, index(words[0])), nodes.Compare("le", word, index(words[-1])))
        return inside, word
    tests: list[tuple[nodes.Expr, int]] = [(nodes.Compare("eq", word, index(number)), value) for number, value in pairs]
    return _any(test for test, _ in tests), _select(tests)


def _numbers(table: Table) -> str:
    numbers = [str(number) for number, _ in table.pairs]
    return ", ".join(numbers if len(numbers) <= SHOWN_NUMBERS else [*numbers[:SHOWN_NUMBERS], "…"])


def _number_constant(writer: Writer, fields: Fields, constant: Constant) -> None:
    where = fields.shown(constant.path)
    scalar = scalar_name(constant.scalar)
    value = nodes.Const(scalar, constant.value if isinstance(constant.value, int | float) else 0)
    if writer.direction == "decode":
        at = writer.position
        found = writer.load(scalar, where, constant.order)
        writer.expect(nodes.Compare("eq", found, value), constant.kind, where, f"must be {constant.value}", at=at)
        if constant.kind == "constant" and constant.path:
            fields.put(constant.path, value)
    else:
        writer.store(value, where, constant.order)


def _text_constant(writer: Writer, fields: Fields, path: tuple[str, ...], value: bytes) -> None:
    where = fields.shown(path)
    writer.require(len(value), where)
    for offset, number, scalar in _words(value):
        at = add(writer.position, offset)
        if writer.direction == "decode":
            found = nodes.Compare("eq", nodes.Load(scalar, at), nodes.Const(scalar, number))
            writer.expect(found, "constant", where, f"must be {value!r}", at=at)
        elif writer.direction == "encode":
            writer.emit(nodes.Store(at, nodes.Const(scalar, number)))
    if writer.direction == "decode" and path:
        fields.put_bytes(path, writer.position, index(len(value)))
    writer.advance(len(value))


def _computed(writer: Writer, fields: Fields, path: tuple[str, ...], scalar: nodes.Scalar, value: expr.Expr, order: str) -> None:
    where = fields.shown(path)
    if writer.direction == "size":
        writer.advance(nodes.WIDTH[scalar])
        return
    if writer.direction == "decode":
        fields.put(path, writer.load(scalar, where, order))
        writer.deferred.append(lambda: counts.agrees(writer, fields, fields.get(path), value, where, "constant"))
    else:
        expected = counts.evaluate(value, fields, writer, where)
        _in_range(writer, where, expected, scalar)
        writer.store(counts.as_scalar(scalar, expected), where, order)


def _padding(writer: Writer, where: Where, scalar: nodes.Scalar, value: int, order: str) -> None:
    if writer.direction == "decode":
        writer.require(nodes.WIDTH[scalar], where)
        writer.advance(nodes.WIDTH[scalar])
    else:
        writer.store(nodes.Const(scalar, value), where, order)


def distance(writer: Writer, size: int) -> nodes.Expr:
    """How many bytes there are to the next multiple of ``size`` bytes from the origin."""
    return nodes.Binary("and", nodes.Binary("sub", writer.origin, writer.position), index(size - 1))


def align(writer: Writer, size: int, when: nodes.Expr | None = None) -> None:
    """Padding up to a multiple of ``size`` bytes from the origin, always or under a condition."""
    padding = distance(writer, size)
    padding = writer.let("padding", padding if when is None else nodes.Select(when, padding, index(0)))
    writer.require(padding, Where())
    if writer.direction == "encode":
        writer.emit(nodes.Fill(nodes.Wire(writer.position), padding))
    writer.advance(padding)


def _blob(writer: Writer, fields: Fields, blob: Blob) -> None:
    where = fields.shown(blob.path)
    extra = int(blob.terminated)
    if writer.direction == "decode":
        total = counts.read_count(writer, fields, blob.path, blob.count, "length", least=extra)
        writer.require(total, where)
        size = _without_terminator(writer, total, where) if blob.terminated else total
        if blob.text:
            writer.expect(nodes.IsText(nodes.Wire(writer.position), size), "text", where, "not valid UTF-8")
        fields.put_bytes(blob.path, writer.position, size)
        writer.advance(total)
        return
    stored = fields.stored(blob.path)
    counts.write_count(writer, fields, blob.count, stored.size, where, "length", extra=extra)
    writer.require(stored.size, where, "no room for the message")
    if writer.direction == "encode":
        fields.copy_bytes(blob.path, stored)
    writer.advance(stored.size)
    if blob.terminated:
        writer.store(nodes.Const("u8", 0), where)


def _utf16(writer: Writer, fields: Fields, text: Utf16) -> None:
    where = fields.shown(text.path)
    if writer.direction == "decode":
        units = counts.read_count(writer, fields, text.path, text.count, "length")
        writer.require(mul(units, 2), where)
        little, marks = _byte_order_mark(writer, units)
        begin = writer.let("text", add(writer.position, mul(marks, 2)))
        count = writer.let("units", nodes.Binary("sub", units, marks))
        writer.expect(nodes.Compare("ge", count, index(0)), "length", where, "no such length")  # true anyway; said for the proof
        elements = fields.open(text.path, count)
        with _each(writer, count) as number:
            at = writer.let("unit", add(begin, mul(number, 2)))
            writer.require(2, where, at=at)
            elements.at(number).put((), nodes.Select(little, nodes.Load("u16", at), nodes.Load("u16", at, ">")))
        writer.advance(mul(units, 2))
        return
    stored = fields.stored(text.path)
    writer.expect(nodes.Compare("lt", stored.size, index(1 << 30)), "range", where, "too many for the wire")
    marks = writer.let("marks", nodes.Convert("i64", nodes.Compare("gt", stored.size, index(0))))
    counts.write_count(writer, fields, text.count, writer.let("units", nodes.Binary("add", stored.size, marks)), where, "length")
    writer.require(mul(add(stored.size, marks), 2), where, "no room for the message")
    begin = writer.position
    if writer.direction == "encode":
        elements = fields.elements(text.path, stored)
        with writer.nested() as marked:
            writer.require(2, where, at=begin)
            writer.emit(nodes.Store(begin, nodes.Const("u16", 0xFEFF)))
        writer.emit(nodes.If(nodes.Compare("gt", marks, index(0)), tuple(marked)))
        first = writer.let("text", add(begin, mul(marks, 2)))
        with _each(writer, stored.size) as number:
            at = writer.let("unit", add(first, mul(number, 2)))
            writer.require(2, where, at=at)
            unit = elements.at(number).get(())
            assert unit is not None
            writer.emit(nodes.Store(at, unit))
    writer.advance(mul(add(stored.size, marks), 2))


def _byte_order_mark(writer: Writer, units: nodes.Expr) -> tuple[nodes.Expr, nodes.Expr]:
    """Whether a text is little-endian, and how many marks say so."""
    mark = writer.var("mark", nodes.Const("u16", 0))
    with writer.nested() as there:
        writer.require(2, Where(), at=writer.position)
        writer.assign(mark, nodes.Load("u16", writer.position, ">"))
    writer.emit(nodes.If(nodes.Compare("gt", units, index(0)), tuple(there)))
    little = writer.let("little", nodes.Compare("eq", mark, nodes.Const("u16", 0xFFFE)))
    marked = nodes.Binary("or", little, nodes.Compare("eq", mark, nodes.Const("u16", 0xFEFF)))
    return little, writer.let("marks", nodes.Select(marked, index(1), index(0)))


@contextmanager
def _each(writer: Writer, count: nodes.Expr) -> Generator[nodes.Local]:
    """A loop over so many elements; gives the number of each."""
    number = nodes.Local("i64", writer.fresh("i"))
    with writer.nested() as body:
        yield number
    writer.emit(nodes.For(number.name, count, tuple(body)))


def _without_terminator(writer: Writer, total: nodes.Expr, where: Where) -> nodes.Expr:
    last = nodes.Load("u8", nodes.Binary("sub", nodes.Binary("add", writer.position, total), index(1)))
    writer.expect(nodes.Compare("eq", last, nodes.Const("u8", 0)), "constant", where, "a string must end with NUL")
    return writer.let("length", nodes.Binary("sub", total, index(1)))


# --- small things -----------------------------------------------------------------------------------------------------------


def _in_range(writer: Writer, where: Where, value: nodes.Expr, scalar: nodes.Scalar) -> None:
    limit = counts.LIMITS[scalar]
    low = -limit if scalar.startswith("i") else 0
    inside = nodes.Binary("and", nodes.Compare("ge", value, index(low)), nodes.Compare("lt", value, index(limit)))
    writer.expect(inside, "range", where, "does not fit on the wire")


def _any(tests: Iterable[nodes.Expr]) -> nodes.Expr:
    result: nodes.Expr | None = None
    for test in tests:
        result = test if result is None else nodes.Binary("or", result, test)
    return result or nodes.Const("bool", value=False)


def _select(pairs: list[tuple[nodes.Expr, int]]) -> nodes.Expr:
    result: nodes.Expr = index(pairs[-1][1])
    for test, value in reversed(pairs[:-1]):
        result = nodes.Select(test, index(value), result)
    return result


def _words(value: bytes) -> list[tuple[int, int, nodes.Scalar]]:
    """Bytes as the fewest little-endian words: offset, number, type."""
    words: list[tuple[int, int, nodes.Scalar]] = []
    offset = 0
    sizes: tuple[tuple[int, nodes.Scalar], ...] = ((8, "u64"), (4, "u32"), (2, "u16"), (1, "u8"))
    while offset < len(value):
        size, scalar = next(each for each in sizes if each[0] <= len(value) - offset)
        words.append((offset, int.from_bytes(value[offset : offset + size], "little"), scalar))
        offset += size
    return words
