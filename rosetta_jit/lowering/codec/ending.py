"""The end of a message: the padding behind it, and what may be left over."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import (
    WIDTH,
    Binary,
    Block,
    Compare,
    Const,
    Convert,
    Expect,
    Expr,
    For,
    If,
    Load,
    Local,
    Return,
    Store,
)
from rosetta_jit.kernel.terms import BEGIN, END, add, index, split
from rosetta_jit.lowering.codec.leaves import align, distance
from rosetta_jit.lowering.writer import MESSAGE, Writer, block, integer
from rosetta_jit.wire.codec import Encoding, Ending

BITS = 3
"""Those of the byte that say how much padding there is."""
LEFT_OVER = "bytes are left over"
UNUSUAL_LENGTH = "not of the usual length"
REMEDY = 'lenient=["trailing"]'
ANY = 1 << 31
"""Where so many bytes may be left over, there are no more in any message."""
NOT_TRIED = index(-1)
"""Where an attempt fails that has not looked at the message: whatever the next one finds lies farther."""


def end(writer: Writer, encoding: Encoding) -> None:
    """Behind the value of a message: nothing more is read than may be there, and its padding is written."""
    ending, most = encoding.ending, encoding.forgivable
    if writer.direction != "decode":
        if ending is not None:
            _pad(writer, ending)
        return
    if encoding.spare:
        _at_most(writer, encoding.spare)
        return
    stated = index(0) if ending is None else _skip(writer, ending)
    if ending is None and not 0 < most < ANY:
        writer.expect(
            Compare("eq", writer.position, END), "trailing", MESSAGE, f"{LEFT_OVER}; {REMEDY} leaves them alone" if most else LEFT_OVER
        )
        return
    with writer.nested() as longer:
        _at_most(writer, most)
        _zeros(writer, 1 if ending is None else ending.unstated, stated, f"{LEFT_OVER}; {REMEDY} forgives up to {most}")
    writer.emit(If(Compare("lt", writer.position, END), block(longer)))


def length_first(writer: Writer, body: Block) -> Block:
    """The body of an attempt that leaves what is wrong to a later one: where all its messages have one length, it begins with that.

    What it asks of the length field by field follows from it, and is not asked any more (`rosetta_jit.kernel.passes.drop`).
    """
    match body:
        case (*before, Expect(Compare("eq", place, end) as is_usual), Return() as last) if end == END and split(place)[0] == BEGIN:
            return (Expect(is_usual, writer.failure("trailing", MESSAGE, UNUSUAL_LENGTH, at=NOT_TRIED)), *before, last)
        case _:
            return body


def refuse_other_length(writer: Writer) -> None:
    """Behind what an attempt with that length would have read, which has failed: the message is longer, or the attempt has said why."""
    writer.expect(Compare("eq", writer.position, END), "trailing", MESSAGE, LEFT_OVER)
    refuse_tried(writer)


def refuse_tried(writer: Writer) -> None:
    """Fail where an earlier attempt has, which has said why."""
    writer.expect(Const("bool", value=False), "trailing", MESSAGE, UNUSUAL_LENGTH, at=NOT_TRIED)


def _skip(writer: Writer, ending: Ending) -> Expr:
    """Exactly as much padding as is announced, whatever its bytes are; gives its size."""
    place = add(BEGIN, ending.size_byte)
    writer.require(WIDTH["u8"], MESSAGE, at=place)
    size = writer.let("padding", Binary("and", integer(Load("u8", place)), index(BITS)))
    writer.require(size, MESSAGE, "the padding that its header announces is not there")
    writer.advance(size)
    return size


def _at_most(writer: Writer, size: int) -> None:
    """No more bytes are left over than ``trailing`` forgives."""
    writer.expect(Compare("ge", add(writer.position, size), END), "trailing", MESSAGE, f"more than {size} bytes are left over")


def _zeros(writer: Writer, multiple: int, stated: Expr, detail: str) -> None:
    """All that is left over are zeros up to the next multiple of so many bytes, and no other padding was announced."""
    padding = writer.let("zeros", distance(writer, multiple))
    whole = Compare("eq", add(writer.position, padding), END)
    writer.expect(Binary("and", Compare("eq", stated, index(0)), whole), "trailing", MESSAGE, detail)
    number = Local("i64", writer.fresh("i"))
    with writer.nested() as body:
        at = writer.let("at", add(writer.position, number))
        writer.require(WIDTH["u8"], MESSAGE, at=at)
        writer.expect(Compare("eq", Load("u8", at), Const("u8", 0)), "trailing", MESSAGE, detail)
    writer.emit(For(number.name, padding, block(body)))


def _pad(writer: Writer, ending: Ending) -> None:
    if ending.align == 1:
        return
    behind = writer.position
    align(writer, ending.align)
    if writer.direction == "encode" and ending.unstated == 1:
        place = add(BEGIN, ending.size_byte)
        writer.require(WIDTH["u8"], MESSAGE, "no room for the message", at=place)
        writer.emit(Store(place, Convert("u8", Binary("sub", writer.position, behind))))
