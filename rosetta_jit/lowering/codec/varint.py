"""Base-128 integers of protobuf, read."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.errors import Kind
from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Expr, If, Load, Local, Select, While
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.writer import MESSAGE, Contract, Where, Writer, block
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.wire.codec import Varint

SEVEN_BITS = Const("u64", 0x7F)
ONE, ZERO = Const("u64", 1), Const("u64", 0)
ONE_BYTE, TWO_BYTES = Const("u64", 1 << 7), Const("u64", 1 << 14)
"""What varints of one byte, and of two, stay below."""
MORE = Const("u8", 1 << 7)
"""What a byte is at least that is not the last one."""
VARINT_BYTES = 10
"""Of a varint."""
GUESSED = 5
"""Bytes of a varint up to which it is read and written byte by byte: those that 32 bits take."""
LARGEST_TAG, LARGEST_LENGTH = (1 << 32) - 1, (1 << 31) - 1
"""Of 29 bits for a field's number and three for how its value is written; and of protobuf's messages."""


def read_varint(writer: Writer, where: Where) -> Local:
    """The next varint as a u64."""
    value, writer.position = writer.call("read_varint", _read, (writer.position,), where)
    return value


def read_element(writer: Writer, where: Where) -> Local:
    """The same of many behind tags of their own: two bytes are as common as one there, and never cost a call."""
    value, writer.position = writer.call("read_element", _read_element, (writer.position,), where)
    return value


def read_packed(writer: Writer, where: Where) -> Local:
    """The same of many, one behind the other."""
    value, writer.position = writer.call("read_packed", _read_element, (writer.position,), where)
    return value


def read_tag(writer: Writer, where: Where) -> Local:
    """The same for what has two bytes as often as one: fields have numbers from 16 on, too."""
    writer.require(1, where)
    value, writer.position = writer.call("read_tag", _read_tag, (writer.position,), where)
    return value


def read_size(writer: Writer, where: Where) -> Local:
    """A number of bytes as a u64: below 2 GiB, as no message is larger, and of five bytes at most, as upb has it."""
    value, writer.position = writer.call("read_size", _read_size, (writer.position,), where)
    return value


def read_length(writer: Writer, where: Where, stop: Expr) -> Local:
    """A length of bytes that follow, and are there."""
    size = writer.let("length", Convert("i64", read_size(writer, where)))
    fits = Compare("le", size, Binary("sub", stop, writer.position))
    writer.expect(fits, "truncated", where, "longer than what is left of the message")
    writer.require(size, where)
    return size


def _read_size(writer: Writer) -> Contract:
    """As of any varint: lengths of two bytes are common, too."""
    made = _first_of_two(writer, lambda at: writer.call("read_size_of_two_bytes", _read_size_of_two, (at,), MESSAGE))
    return _at_most(LARGEST_LENGTH, made)


def _read_size_of_two(writer: Writer) -> Contract:
    made = _two_bytes(writer, lambda at: writer.call("read_long_size", _read_long_size, (at,), MESSAGE))
    return _at_most(LARGEST_LENGTH, made)


def _read_long_size(writer: Writer) -> Contract:
    return _short(writer, LARGEST_LENGTH, "a length", "truncated", "length")


def _read_long_tag(writer: Writer) -> Contract:
    return _short(writer, LARGEST_TAG, "a tag", "tag", "tag")


def _short(writer: Writer, most: int, what: str, too_large: Kind, too_long: Kind) -> Contract:
    """A varint of several bytes that is at most a number of 32 bits, and no longer than those take."""
    at = writer.parameter("at", "i64")
    value, after = writer.call("read_long_varint", _read_long, (at,), MESSAGE)
    writer.expect(Compare("le", value, Const("u64", most)), too_large, MESSAGE, f"{what} of more than {most}", at=at)
    writer.expect(Compare("le", Binary("sub", after, at), index(GUESSED)), too_long, MESSAGE, f"{what} of more than five bytes", at=at)
    return _at_most(most, Contract((at,), (value, after), writer.within(at), (*writer.within(after), _is_long(at, after))))


def _at_most(most: int, contract: Contract) -> Contract:
    """What gives a number that is not larger than another one."""
    value, _ = contract.results
    return replace(contract, ensures=(*contract.ensures, Compare("le", value, Const("u64", most))))


def _read(writer: Writer) -> Contract:
    """One byte is the common case, which costs no call; nor do two, unless very many varints are read: each length has a routine."""
    return _first_of_two(writer, lambda at: writer.call("read_two_bytes", _read_two, (at,), MESSAGE))


def _read_two(writer: Writer) -> Contract:
    return _two_bytes(writer, lambda at: writer.call("read_long_varint", _read_long, (at,), MESSAGE))


def _first_of_two(writer: Writer, further: Callable[[Local], tuple[Local, ...]]) -> Contract:
    """A byte alone, or what a routine reads from its place on."""
    at = writer.parameter("at", "i64")
    writer.position = at
    byte = writer.let("byte", writer.load("u8", MESSAGE))
    value, after = _first_byte(writer, at, byte)
    _if_more(writer, byte, lambda: _become(writer, further(at), value, after))
    return Contract((at,), (value, after), writer.within(at), writer.behind(at, after))


def _two_bytes(writer: Writer, further: Callable[[Local], tuple[Local, ...]]) -> Contract:
    """Two bytes, or what begins at a place, of which the first is there."""
    at = writer.parameter("at", "i64")
    first = writer.let("byte", Load("u8", at))
    value, after = _first_byte(writer, at, first)
    _second(writer, first, at, lambda: further(at), value, after)
    return Contract((at,), (value, after), _is_there(at), writer.behind(at, after))


def _read_element(writer: Writer) -> Contract:
    """Of very many numbers each comparison costs: where a second byte is not there, this says so itself."""
    at = writer.parameter("at", "i64")
    writer.position = at
    first = writer.let("byte", writer.load("u8", MESSAGE))
    value, after = _first_byte(writer, at, first)

    def second() -> None:
        byte = writer.let("byte", writer.load("u8", MESSAGE))
        longer = writer.var("varint", _of_two(first, byte)), writer.var("next", writer.position)
        _if_more(writer, byte, lambda: _become(writer, writer.call("read_long_varint", _read_long, (at,), MESSAGE), *longer))
        _become(writer, longer, value, after)

    _if_more(writer, first, second)
    return Contract((at,), (value, after), writer.within(at), writer.behind(at, after))


def _read_tag(writer: Writer) -> Contract:
    """There is a byte: a message that goes on has one."""
    at = writer.parameter("at", "i64")
    return _in_place(writer, at, Load("u8", at), lambda: writer.call("read_long_tag", _read_long_tag, (at,), MESSAGE))


def _in_place(writer: Writer, at: Local, first: Expr, further: Callable[[], tuple[Local, ...]]) -> Contract:
    """A byte alone or two of them, without a call, or what begins at a place."""
    byte = writer.let("byte", first)
    value, after = _first_byte(writer, at, byte)
    _if_more(writer, byte, lambda: _second(writer, byte, at, further, value, after))
    return Contract((at,), (value, after), _is_there(at), writer.behind(at, after))


def _is_there(at: Local) -> tuple[Expr, ...]:
    """The claim that the byte at a place is there."""
    return Compare("ge", at, BEGIN), Compare("ge", Binary("sub", END, at), index(1))


def _first_byte(writer: Writer, at: Local, byte: Local) -> tuple[Local, Local]:
    """The value and the place behind it, as they are if the byte is the last one."""
    return writer.var("varint", Convert("u64", byte)), writer.var("next", add(at, 1))


def _second(writer: Writer, first: Local, at: Local, further: Callable[[], tuple[Local, ...]], value: Local, after: Local) -> None:
    """The same if the next byte is the last one, or there are more. Where the message ends, ``further`` fails there."""
    byte = writer.var("byte", MORE)
    with writer.nested() as there:
        writer.assign(byte, Load("u8", add(at, 1)))
        writer.assign(after, add(at, 2))
    writer.emit(If(Compare("ge", Binary("sub", END, at), index(2)), block(there)))
    writer.assign(value, _of_two(first, byte))
    _if_more(writer, byte, lambda: _become(writer, further(), value, after))


def _of_two(first: Local, second: Local) -> Expr:
    """What two bytes stand for, if the second one is the last."""
    low = Binary("and", Convert("u64", first), SEVEN_BITS)
    return Binary("or", low, Binary("shl", Convert("u64", second), Const("u64", 7)))


def _become(writer: Writer, results: tuple[Local, ...], value: Local, after: Local) -> None:
    for variable, result in zip((value, after), results, strict=True):
        writer.assign(variable, result)


def _if_more(writer: Writer, byte: Local, further: Callable[[], None]) -> None:
    """If the byte is not the last one, what is further done."""
    with writer.nested() as more:
        further()
    writer.emit(If(Compare("ge", byte, MORE), block(more)))


def _read_long(writer: Writer) -> Contract:
    """At most ten bytes are read, and bits above the 64th are dropped; the first eight at once, where the message has as many."""
    at, where = writer.parameter("at", "i64"), MESSAGE
    writer.position = at
    byte = writer.var("byte", writer.load("u8", where))
    value, after = writer.var("varint", Binary("and", Convert("u64", byte), SEVEN_BITS)), writer.var("next", writer.position)
    shift = writer.var("shift", index(7))
    with writer.nested() as at_once:
        _read_at_once(writer, at, value, after, byte)
        writer.assign(shift, index(56))
    writer.emit(If(Compare("ge", Binary("sub", END, at), index(8)), block(at_once)))
    with writer.nested() as body:
        writer.position = after
        writer.assign(byte, writer.load("u8", where))
        writer.assign(after, writer.position)
        bits = Binary("shl", Binary("and", Convert("u64", byte), SEVEN_BITS), Convert("u64", shift))
        writer.assign(value, Binary("or", value, bits))
        writer.assign(shift, add(shift, 7))
    unfinished = Compare("ge", byte, MORE)
    invariant = (
        *writer.behind(at, after),
        Compare("ge", shift, index(7)),
        Compare("le", shift, index(70)),
    )
    writer.emit(While(Binary("and", unfinished, Compare("lt", shift, index(64))), block(body), invariant, shift))
    writer.expect(Compare("lt", byte, MORE), "varint", where, "an integer of more than ten bytes")
    writer.expect(
        _is_long(at, after), "truncated", where, "the message ends here"
    )  # said for the proof: the first byte is not the last one
    return Contract((at,), (value, after), writer.within(at), (*writer.within(after), _is_long(at, after)))


def _is_long(at: Local, after: Local) -> Compare:
    """The claim that there are two bytes or more."""
    return Compare("ge", after, add(at, 2))


def _read_at_once(writer: Writer, at: Local, value: Local, after: Local, byte: Local) -> None:
    """Processors guess which of a few bytes is the last, and go on behind it before they have read it; of many, they compute it."""
    word = writer.let("word", Load("u64", at))
    with writer.nested() as many:
        joined, behind, stops = writer.call("read_eight", _read_eight, (at, word), MESSAGE)
        writer.assign(value, joined)
        writer.assign(after, behind)
        writer.assign(byte, Select(Compare("eq", stops, ZERO), Const("u8", 128), Const("u8", 0)))
    with writer.nested() as few:
        writer.assign(byte, Const("u8", 0))
        _read_guessed(writer, at, word, value, after)
    writer.emit(If(ends_within(word), block(few), block(many)))


def ends_within(word: Expr) -> Expr:
    """Whether the varint that eight bytes begin with is short enough to be read byte by byte."""
    goes_on = Const("u64", int.from_bytes(b"\x80" * GUESSED, "little"))
    return Compare("ne", Binary("and", word, goes_on), goes_on)


def read_short(writer: Writer, at: Local, word: Local) -> tuple[Local, Local]:
    """The varint that eight bytes at a place begin with, if it ends within those that are read byte by byte, and the place behind it."""
    value, after = writer.call("read_short", _read_short, (at, word), MESSAGE)
    return value, after


def _read_short(writer: Writer) -> Contract:
    at, word = writer.parameter("at", "i64"), writer.parameter("word", "u64")
    value, after = writer.var("varint", Binary("and", word, SEVEN_BITS)), writer.var("next", add(at, 1))
    with writer.nested() as longer:
        _read_guessed(writer, at, word, value, after)
    writer.emit(If(Compare("ne", Binary("and", word, Const("u64", 0x80)), ZERO), block(longer)))
    size_is_known = (Compare("ge", after, add(at, 1)), Compare("le", after, add(at, GUESSED)))
    return Contract((at, word), (value, after), writer.within(at), size_is_known)


def _read_guessed(writer: Writer, at: Local, word: Local, value: Local, after: Local, known: int = 1) -> None:
    shifted = Binary("shr", word, Const("u64", known))
    writer.assign(value, Binary("or", value, Binary("and", shifted, Const("u64", 0x7F << 7 * known))))
    writer.assign(after, add(at, known + 1))
    if known + 1 < GUESSED:
        with writer.nested() as longer:
            _read_guessed(writer, at, word, value, after, known + 1)
        ends = Compare("eq", Binary("and", word, Const("u64", 0x80 << 8 * known)), ZERO)
        writer.emit(If(ends, (), block(longer)))


def _read_eight(writer: Writer) -> Contract:
    """What the eight bytes at a place begin with, or are all of, and which of them end an integer."""
    at, word = writer.parameter("at", "i64"), writer.parameter("word", "u64")
    stops = writer.let("stops", Binary("xor", Binary("and", word, _each_byte(0x80)), _each_byte(0x80)))
    last = writer.let("last", Binary("or", stops, Const("u64", 1 << 63)))
    mask = writer.let("mask", Binary("xor", last, Binary("sub", last, ONE)))
    value = _joined(writer, Binary("and", word, mask))
    after = writer.let("next", Binary("add", at, _bytes_of(writer, mask)))
    enough = Compare("ge", Binary("sub", END, at), index(8))
    return Contract((at, word), (value, after, stops), (Compare("ge", at, BEGIN), enough), writer.behind(at, after))


def _each_byte(value: int) -> Const:
    return Const("u64", int.from_bytes(bytes([value]) * 8, "little"))


def _joined(writer: Writer, word: Expr) -> Local:
    """The lower seven bits of each byte, put together: those of pairs of bytes, of pairs of pairs, and of their pairs."""
    bits = writer.let("bits", Binary("and", word, _each_byte(0x7F)))
    for width in (7, 14, 28):
        low = sum((1 << width) - 1 << place for place in range(0, 64, width // 7 * 16))
        shift = width // 7
        upper = Binary("and", Binary("shr", bits, Const("u64", shift)), Const("u64", low << width))
        bits = writer.let("bits", Binary("or", Binary("and", bits, Const("u64", low)), upper))
    return bits


def _bytes_of(writer: Writer, mask: Local) -> Expr:
    """How many bytes of a mask are set, one to eight: the lowest, and the sum of a bit of each other one."""
    bits = writer.let("count", Binary("and", Binary("shr", mask, Const("u64", 8)), _each_byte(1)))
    for width in (32, 16, 8):
        bits = writer.let("count", Binary("add", bits, Binary("shr", bits, Const("u64", width))))
    return add(Convert("i64", Binary("and", bits, Const("u64", 7))), 1)


def from_varint(varint: Varint, value: Local, scalar: str) -> Expr:
    """The number that a varint stands for, with at least the scalar's low bits right."""
    if not varint.zigzag:
        return value
    bits: Expr = Binary("and", value, Const("u64", (1 << 32) - 1)) if scalar.endswith("32") else value
    sign = Select(Compare("ne", Binary("and", bits, ONE), ZERO), Const("u64", (1 << 64) - 1), ZERO)
    return Binary("xor", Binary("shr", bits, ONE), sign)
