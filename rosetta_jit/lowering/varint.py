"""Base-128 integers of protobuf: read, written, and their size."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Binary, Compare, Const, Convert, Expr, If, Local, Select, While, add, index, type_of
from rosetta_jit.lowering.writer import MESSAGE, Contract, Where, Writer, block

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.wire.codec import Varint

SEVEN_BITS = Const("u64", 0x7F)
ONE, ZERO = Const("u64", 1), Const("u64", 0)
MAX_BYTES = 10
"""Of a varint."""


def read_varint(writer: Writer, where: Where) -> Local:
    """The next varint as a u64."""
    value, writer.position = writer.call("read_varint", _read, (writer.position,), where)
    return value


def read_tag(writer: Writer, where: Where) -> Local:
    """The same for what has two bytes as often as one: fields have numbers from 16 on, too."""
    value, writer.position = writer.call("read_tag", _read_tag, (writer.position,), where)
    return value


def _read(writer: Writer) -> Contract:
    """One byte is the common case, which costs no call: what reads more is a routine of its own."""
    return _first_byte(writer, lambda _, at: writer.call("read_long_varint", _read_long, (at,), MESSAGE))


def _read_tag(writer: Writer) -> Contract:
    def second(first: Local, at: Local) -> tuple[Local, ...]:
        byte = writer.let("byte", writer.load("u8", MESSAGE))
        low = Binary("and", Convert("u64", first), SEVEN_BITS)
        value = writer.var("varint", Binary("or", low, Binary("shl", Convert("u64", byte), Const("u64", 7))))
        after = writer.var("next", writer.position)
        _if_more(writer, byte, lambda: writer.call("read_long_varint", _read_long, (at,), MESSAGE), value, after)
        return value, after

    return _first_byte(writer, second)


def _first_byte(writer: Writer, further: Callable[[Local, Local], tuple[Local, ...]]) -> Contract:
    """A byte alone, or, behind the byte and the place where it stands, what it begins."""
    at = writer.parameter("at", "i64")
    writer.position = at
    byte = writer.let("byte", writer.load("u8", MESSAGE))
    value, after = writer.var("varint", Convert("u64", byte)), writer.var("next", writer.position)
    _if_more(writer, byte, lambda: further(byte, at), value, after)
    return Contract((at,), (value, after), writer.within(at), writer.behind(at, after))


def _if_more(writer: Writer, byte: Local, further: Callable[[], tuple[Local, ...]], value: Local, after: Local) -> None:
    """If the byte is not the last one, the value and the place behind it are others."""
    with writer.nested() as more:
        longer, behind = further()
        writer.assign(value, longer)
        writer.assign(after, behind)
    writer.emit(If(Compare("ge", byte, Const("u8", 128)), block(more)))


def _read_long(writer: Writer) -> Contract:
    """At most ten bytes are read, and bits above the 64th are dropped."""
    at, where = writer.parameter("at", "i64"), MESSAGE
    writer.position = at
    byte = writer.var("byte", writer.load("u8", where))
    value, after = writer.var("varint", Binary("and", Convert("u64", byte), SEVEN_BITS)), writer.var("next", writer.position)
    shift = writer.var("shift", index(7))
    with writer.nested() as body:
        writer.position = after
        writer.assign(byte, writer.load("u8", where))
        writer.assign(after, writer.position)
        bits = Binary("shl", Binary("and", Convert("u64", byte), SEVEN_BITS), Convert("u64", shift))
        writer.assign(value, Binary("or", value, bits))
        writer.assign(shift, add(shift, 7))
    unfinished = Compare("ge", byte, Const("u8", 128))
    invariant = (
        *writer.behind(at, after),
        Compare("ge", shift, index(7)),
        Compare("le", shift, index(70)),
    )
    writer.emit(While(Binary("and", unfinished, Compare("lt", shift, index(64))), block(body), invariant, shift))
    writer.expect(Compare("lt", byte, Const("u8", 128)), "varint", where, "an integer of more than ten bytes")
    return Contract((at,), (value, after), writer.within(at), writer.behind(at, after))


def write_varint(writer: Writer, value: Expr, where: Where) -> None:
    """Write a u64 in as few bytes as it takes, or count them."""
    if isinstance(value, Const):
        for byte in varint_bytes(int(value.value)):
            writer.store(Const("u8", byte), where)
    elif writer.direction == "size":
        (size,) = writer.call("varint_size", _size, (value,), where)
        writer.advance(size)
    else:
        (writer.position,) = writer.call("write_varint", _write, (writer.position, value), where)


def _write(writer: Writer) -> Contract:
    """One byte is the common case, here as in reading."""
    at, value = writer.parameter("at", "i64"), writer.parameter("value", "u64")
    after = writer.var("next", at)
    with writer.nested() as one:
        writer.position = at
        writer.store(Convert("u8", value), MESSAGE)
        writer.assign(after, writer.position)
    with writer.nested() as several:
        (behind,) = writer.call("write_long_varint", _write_long, (at, value), MESSAGE)
        writer.assign(after, behind)
    writer.emit(If(Compare("lt", value, Const("u64", 128)), block(one), block(several)))
    return Contract((at, value), (after,), writer.within(at), writer.behind(at, after))


def _write_long(writer: Writer) -> Contract:
    at, value = writer.parameter("at", "i64"), writer.parameter("value", "u64")
    after, rest, count = writer.var("next", at), writer.var("rest", value), writer.var("count", index(0))
    with writer.nested() as body:
        writer.position = after
        writer.store(Convert("u8", Binary("or", Binary("and", rest, SEVEN_BITS), Const("u64", 128))), MESSAGE)
        writer.assign(after, writer.position)
        writer.assign(rest, Binary("shr", rest, Const("u64", 7)))
        writer.assign(count, add(count, 1))
    invariant = (
        *writer.within(after),
        Compare("ge", after, at),
        Compare("ge", count, index(0)),
        Compare("le", count, index(MAX_BYTES - 1)),
    )
    writer.emit(While(_more(rest, count), block(body), invariant, count))
    writer.position = after
    writer.store(Convert("u8", rest), MESSAGE)
    writer.assign(after, writer.position)
    return Contract((at, value), (after,), writer.within(at), writer.behind(at, after))


def _size(writer: Writer) -> Contract:
    value = writer.parameter("value", "u64")
    size = writer.var("size", index(1))
    with writer.nested() as several:
        (long,) = writer.call("long_varint_size", _long_size, (value,), MESSAGE)
        writer.assign(size, long)
    writer.emit(If(Compare("ge", value, Const("u64", 128)), block(several)))
    return Contract((value,), (size,), (), _bounds(size))


def _long_size(writer: Writer) -> Contract:
    value = writer.parameter("value", "u64")
    rest, size = writer.var("rest", value), writer.var("size", index(1))
    with writer.nested() as body:
        writer.assign(rest, Binary("shr", rest, Const("u64", 7)))
        writer.assign(size, add(size, 1))
    writer.emit(While(_more(rest, add(size, -1)), block(body), _bounds(size), size))
    return Contract((value,), (size,), (), _bounds(size))


def _bounds(size: Local) -> tuple[Expr, Expr]:
    return Compare("ge", size, index(1)), Compare("le", size, index(MAX_BYTES))


def _more(rest: Expr, written: Expr) -> Expr:
    """Whether another byte follows the one at hand."""
    return Binary("and", Compare("ge", rest, Const("u64", 128)), Compare("lt", written, index(MAX_BYTES - 1)))


def varint_bytes(value: int) -> bytes:
    """A varint that is known."""
    written = bytearray()
    while value >= 128:
        written.append(value & 127 | 128)
        value >>= 7
    written.append(value)
    return bytes(written)


def from_varint(varint: Varint, value: Local, scalar: str) -> Expr:
    """The number that a varint stands for, with at least the scalar's low bits right."""
    if not varint.zigzag:
        return value
    bits: Expr = Binary("and", value, Const("u64", (1 << 32) - 1)) if scalar.endswith("32") else value
    sign = Select(Compare("ne", Binary("and", bits, ONE), ZERO), Const("u64", (1 << 64) - 1), ZERO)
    return Binary("xor", Binary("shr", bits, ONE), sign)


def to_varint(varint: Varint, value: Expr) -> Expr:
    """The u64 that a number is written as: sign-extended, or with the sign in the lowest bit."""
    scalar = type_of(value)
    if not varint.zigzag:
        return value if scalar == "u64" else Convert("u64", value if scalar in ("bool", "u8", "u16", "u32") else _wide(value))
    wide = _wide(value)
    shifted = Binary("shl", Convert("u64", wide), ONE)
    return Binary("xor", shifted, Select(Compare("lt", wide, index(0)), Const("u64", (1 << 64) - 1), ZERO))


def _wide(value: Expr) -> Expr:
    return value if type_of(value) == "i64" else Convert("i64", value)
