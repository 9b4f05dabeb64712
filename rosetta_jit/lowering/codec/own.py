"""A message whose holder is of the wire's own type, lowered in one of four ways. What one of them needs is imported for it alone."""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.kernel.terms import END, index
from rosetta_jit.lowering.codec.holder_fields import HolderFields
from rosetta_jit.lowering.codec.walk import walk
from rosetta_jit.wire.codec import Codec, Encoding, Tagged


def lower_own(encoding: Encoding, attempt: Codec, holder: HolderFields) -> None:
    """Read or write a message, or its size, as an attempt of its encoding says."""
    writer = holder.writer
    if encoding.nested:
        from rosetta_jit.lowering.codec.descent import descend

        descend(_nested(encoding, attempt), attempt, holder, writer)
    elif not isinstance(attempt, Tagged):
        with writer.whole():
            walk(attempt, holder, writer)
    elif writer.direction == "decode":
        from rosetta_jit.lowering.codec.recursion import cursors, read_rows
        from rosetta_jit.lowering.codec.tagged import read_message

        rows = cursors(writer, holder.layout)
        read_message(writer, holder, attempt, END, fresh=True, depth=index(0))
        read_rows(encoding, holder, writer, rows)
    else:
        from rosetta_jit.lowering.codec.recursion_write import write_root

        write_root(encoding, holder, attempt, writer)


def _nested(encoding: Encoding, attempt: Codec) -> Mapping[str, Codec]:
    """The codecs of recursive structs in the messages of an attempt."""
    number = next((number for number, each in enumerate(encoding.attempts) if each is attempt), 0)
    return encoding.nested[number]
