"""The end of a message: the padding that it announces, and what may be left over."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import WIDTH, Binary, Compare, Convert, Load, Store
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.leaves import align
from rosetta_jit.lowering.writer import MESSAGE, integer

if TYPE_CHECKING:
    from rosetta_jit.lowering.writer import Writer
    from rosetta_jit.wire.codec import Encoding, Ending

BITS = 3
"""Those of the byte that say how much padding there is."""


def end(writer: Writer, encoding: Encoding) -> None:
    """Behind the value of a message: nothing more is read than may be there, and its padding is written."""
    if writer.direction != "decode":
        if encoding.ending is not None:
            _pad(writer, encoding.ending)
    elif encoding.spare:
        writer.expect(Compare("ge", add(writer.position, encoding.spare), END), "trailing", MESSAGE, "bytes are left over")
    else:
        if encoding.ending is not None:
            _skip(writer, encoding.ending)
        writer.expect(Compare("eq", writer.position, END), "trailing", MESSAGE, "bytes are left over")


def _skip(writer: Writer, ending: Ending) -> None:
    """Exactly as much padding as is announced, whatever its bytes are."""
    told = add(BEGIN, ending.told)
    writer.require(WIDTH["u8"], MESSAGE, at=told)
    size = writer.let("padding", Binary("and", integer(Load("u8", told)), index(BITS)))
    writer.require(size, MESSAGE, "the padding that its header announces is not there")
    writer.advance(size)


def _pad(writer: Writer, ending: Ending) -> None:
    if ending.align == 1:
        return
    behind = writer.position
    align(writer, ending.align)
    if writer.direction == "encode":
        told = add(BEGIN, ending.told)
        writer.require(WIDTH["u8"], MESSAGE, "no room for the message", at=told)
        writer.emit(Store(told, Convert("u8", Binary("sub", writer.position, behind))))
