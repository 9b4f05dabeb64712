"""Counts of elements and bytes: read and checked, written, or computed from other fields as a wire schema says."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Binary, Compare, Convert, Expr, Get, Scalar
from rosetta_jit.kernel.terms import add, index, mul, type_of
from rosetta_jit.lowering.arithmetic import align, binary
from rosetta_jit.lowering.codec.fields import Fields, scalar_name
from rosetta_jit.lowering.limits import MAX_SIZE
from rosetta_jit.lowering.writer import Where, Writer, integer
from rosetta_jit.model import expr
from rosetta_jit.wire.codec import Count

LIMITS = {"i8": 1 << 7, "u8": 1 << 8, "i16": 1 << 15, "u16": 1 << 16, "i32": 1 << 31, "u32": 1 << 32}
"""The first count that a number on the wire cannot carry."""


def read_count(writer: Writer, fields: Fields, path: tuple[str, ...], count: Count, kind: str, *, least: int = 0) -> Expr:
    """A count that has come: not negative, and what the schema says it must be. ``least`` are counted, but are not of the value."""
    where, at = fields.shown(path), writer.position
    found = _implied(writer, fields, count, where) if count.scalar is None else _counted(writer, count, where, least)
    if count.maximum is not None:
        writer.expect(Compare("le", found, index(count.maximum + least)), kind, where, f"at most {count.maximum}", at=at)
    if isinstance(count.value, int):
        if count.scalar is None:
            return found
        writer.expect(Compare("eq", found, index(count.value)), kind, where, f"must be {count.value}", at=at)
        return index(count.value)
    rule = f"must be at least {least}" if least else "must not be negative"
    writer.expect(Compare("ge", found, index(least)), kind, where, rule, at=at)
    value = count.value
    if value is not None and count.scalar is not None:
        writer.deferred.append(lambda: agrees(writer, fields, fields.stored(path).size, value, where, kind))
    return found


def _counted(writer: Writer, count: Count, where: Where, least: int) -> Expr:
    """A count on the wire, of elements and of the ``least`` that are counted with them."""
    at = writer.position
    found = writer.let("count", integer(writer.load(scalar_name(count.scalar or ""), where, count.order)))
    if count.unit == 1:
        return found
    units = add(found, -least)
    whole = Compare("eq", Binary("rem", units, index(count.unit)), index(0))
    writer.expect(
        whole,
        "length",
        where,
        f"must be {least} more than a multiple of {count.unit}" if least else f"must be a multiple of {count.unit}",
        at=at,
    )
    return writer.let("elements", add(Binary("div", units, index(count.unit)), least))


def _implied(writer: Writer, fields: Fields, count: Count, where: Where) -> Expr:
    """A count that the type or another field tells."""
    assert count.value is not None
    return index(count.value) if isinstance(count.value, int) else writer.let("count", evaluate(count.value, fields.scope, writer, where))


def write_count(writer: Writer, fields: Fields, count: Count, value: Expr, where: Where, kind: str = "count", *, extra: int = 0) -> None:
    """A count to be written, ``extra`` more than the value has; one that the schema fixes, or other fields tell, must be that one."""
    if count.maximum is not None:
        writer.expect(Compare("le", value, index(count.maximum)), kind, where, f"at most {count.maximum}")
    if count.value is not None and not isinstance(count.value, int):
        agrees = Compare("eq", value, _implied(writer, fields, count, where))
        writer.expect(agrees, kind, where, "must agree with the fields that determine it")
    value = add(value, extra)
    if isinstance(count.value, int):
        writer.expect(Compare("eq", value, index(count.value)), kind, where, f"must be {count.value}")
    if count.scalar is None:
        return
    scalar = scalar_name(count.scalar)
    if scalar in LIMITS:
        writer.expect(Compare("lt", value, index(-(-LIMITS[scalar] // count.unit))), "range", where, "too many for the wire")
    if count.unit != 1:
        writer.expect(Compare("le", value, index(MAX_SIZE // count.unit)), "range", where, "too many for the wire")
    writer.store(as_scalar(scalar, add(mul(add(value, -extra), count.unit), extra)), where, count.order)


def agrees(writer: Writer, fields: Fields, found: Expr | None, value: expr.Expr, where: Where, kind: str) -> None:
    """Checked when the message has been read, since any of its fields may determine the value."""
    assert found is not None
    known = writer.let("found", integer(found))
    expected = evaluate(value, fields, writer, where)
    writer.expect(Compare("eq", known, expected), kind, where, "must agree with the fields that determine it")


def as_scalar(scalar: Scalar, value: Expr) -> Expr:
    """A value as a scalar of the wire."""
    return value if type_of(value) == scalar else Convert(scalar, value)


def evaluate(value: expr.Expr, fields: Fields, writer: Writer, where: Where) -> Expr:
    """The value as an int64. Paths start at the message and name numbers that come before, or are given."""
    match value:
        case expr.Literal(int(number)):
            return index(number)
        case expr.Path(_, steps):
            path = tuple(step.name for step in steps if isinstance(step, expr.Member))
            found = fields.get(path)
            assert found is not None, path
            return integer(writer.let("told", found) if isinstance(found, Get) else found)  # the proof looks at each reading anew
        case expr.Len(path):
            return fields.stored(tuple(step.name for step in path.steps if isinstance(step, expr.Member))).size
        case expr.Unary(_, operand):
            return binary(writer, "-", index(0), evaluate(operand, fields, writer, where), where)
        case expr.Binary(operator, left, right):
            return binary(writer, operator, evaluate(left, fields, writer, where), evaluate(right, fields, writer, where), where)
        case expr.Call("align", (number, quantum)):
            return align(writer, evaluate(number, fields, writer, where), evaluate(quantum, fields, writer, where), where)
        case _:
            raise AssertionError(value)
