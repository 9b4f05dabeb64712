"""Base-128 integers of protobuf, written, and their size."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Expr, If, Local, Select, While
from rosetta_jit.kernel.terms import add, index, type_of
from rosetta_jit.lowering.codec.varint import GUESSED, ONE, ONE_BYTE, SEVEN_BITS, TWO_BYTES, VARINT_BYTES, ZERO
from rosetta_jit.lowering.writer import MESSAGE, Contract, Where, Writer, block
from rosetta_jit.wire.codec import Varint


def write_varint(writer: Writer, value: Expr, where: Where) -> None:
    """Write a u64 in as few bytes as it takes, or count them."""
    if isinstance(value, Const):
        for byte in varint_bytes(int(value.value)):
            writer.store(Const("u8", byte), where)
    elif writer.direction == "size":
        writer.advance(size_of_varint(writer, value, where))
    else:
        (writer.position,) = writer.call("write_varint", _write, (writer.position, value), where)


def size_of_varint(writer: Writer, value: Expr, where: Where) -> Local:
    """How many bytes a u64 takes: one to `VARINT_BYTES`."""
    (size,) = writer.call("varint_size", _size, (value,), where)
    return size


def _write(writer: Writer) -> Contract:
    """One byte is the common case, here as in reading, and two are the next."""
    return _write_short(writer, 1, "write_two_bytes", _write_two)


def _write_two(writer: Writer) -> Contract:
    """A varint of two bytes, or of more."""
    return _write_short(writer, 2, "write_long_varint", _write_long)


def _write_short(writer: Writer, size: int, longer: str, write_longer: Callable[[Writer], Contract]) -> Contract:
    """A varint of so many bytes, or what another routine writes."""
    at, value = writer.parameter("at", "i64"), writer.parameter("value", "u64")
    after = writer.var("next", at)
    with writer.nested() as short:
        writer.position = at
        for number in range(size):
            rest = Binary("shr", value, Const("u64", 7 * number)) if number else value
            writer.store(Convert("u8", rest if number == size - 1 else Binary("or", rest, Const("u64", 128))), MESSAGE)
        writer.assign(after, writer.position)
    with writer.nested() as several:
        (behind,) = writer.call(longer, write_longer, (at, value), MESSAGE)
        writer.assign(after, behind)
    writer.emit(If(Compare("lt", value, Const("u64", 1 << 7 * size)), block(short), block(several)))
    return Contract((at, value), (after,), writer.within(at), writer.behind(at, after))


def _write_long(writer: Writer) -> Contract:
    at, value = writer.parameter("at", "i64"), writer.parameter("value", "u64")
    after = writer.var("next", at)
    writer.position = at
    _write_guessed(writer, at, value, after)
    return Contract((at, value), (after,), writer.within(at), writer.behind(at, after))


def _write_guessed(writer: Writer, at: Local, rest: Local, after: Local, written: int = 0) -> None:
    """A byte that is not the last one, and those behind it."""
    writer.store(Convert("u8", Binary("or", Binary("and", rest, SEVEN_BITS), Const("u64", 128))), MESSAGE)
    written += 1
    rest = writer.let("rest", Binary("shr", rest, Const("u64", 7)))
    with writer.nested() as last:
        writer.store(Convert("u8", rest), MESSAGE)
        writer.assign(after, writer.position)
    with writer.nested() as more:
        if written < GUESSED - 1:
            _write_guessed(writer, at, rest, after, written)
        else:
            _write_rest(writer, at, rest, after, written)
    writer.emit(If(Compare("lt", rest, ONE_BYTE), block(last), block(more)))


def _write_rest(writer: Writer, at: Local, value: Local, after: Local, written: int) -> None:
    rest, count = writer.var("rest", value), writer.var("count", index(written))
    writer.assign(after, writer.position)
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
        Compare("le", count, index(VARINT_BYTES - 1)),
    )
    writer.emit(While(_more(rest, count), block(body), invariant, count))
    writer.position = after
    writer.store(Convert("u8", rest), MESSAGE)
    writer.assign(after, writer.position)


def _size(writer: Writer) -> Contract:
    value = writer.parameter("value", "u64")
    size = writer.var("size", Select(Compare("lt", value, ONE_BYTE), index(1), index(2)))
    with writer.nested() as several:
        (long,) = writer.call("long_varint_size", _long_size, (value,), MESSAGE)
        writer.assign(size, long)
    writer.emit(If(Compare("ge", value, TWO_BYTES), block(several)))
    return Contract((value,), (size,), (), _bounds(size))


def _long_size(writer: Writer) -> Contract:
    """One byte, and then five if it needs more than five, two if more than two, and so on: no loop, and nothing to guess."""
    value = writer.parameter("value", "u64")
    rest, size = value, writer.let("size", index(1))
    for bytes_ in (5, 2, 1, 1):
        more = writer.let("more", Compare("ge", rest, Const("u64", 1 << 7 * bytes_)))
        size = writer.let("size", Binary("add", size, Select(more, index(bytes_), index(0))))
        rest = writer.let("rest", Select(more, Binary("shr", rest, Const("u64", 7 * bytes_)), rest))
    return Contract((value,), (size,), (), _bounds(size))


def _bounds(size: Local) -> tuple[Expr, Expr]:
    return Compare("ge", size, index(1)), Compare("le", size, index(VARINT_BYTES))


def _more(rest: Expr, written: Expr) -> Expr:
    """Whether another byte follows the one at hand."""
    return Binary("and", Compare("ge", rest, Const("u64", 128)), Compare("lt", written, index(VARINT_BYTES - 1)))


def varint_bytes(value: int) -> bytes:
    """A varint that is known."""
    written = bytearray()
    while value >= 128:
        written.append(value & 127 | 128)
        value >>= 7
    written.append(value)
    return bytes(written)


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
