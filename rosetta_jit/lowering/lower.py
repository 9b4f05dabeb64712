"""From an encoding to a kernel: once for each direction, by the same walk.

Without rules, the fields of the wire are the fields of the holder. With rules, the walk finds the wire's fields, and the rules
relate them to the holder's; each attempt of an encoding becomes a body of the kernel.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import BEGIN, END, ROW, Block, Capacity, Compare, Direction, Fill, Kernel, Return, add, index
from rosetta_jit.kernel.ir import Place as KernelPlace
from rosetta_jit.lowering.bound import Found, WireFields
from rosetta_jit.lowering.descent import descend
from rosetta_jit.lowering.ending import end
from rosetta_jit.lowering.fields import root_fields
from rosetta_jit.lowering.recursion import cursors, read_rows
from rosetta_jit.lowering.recursion_write import write_root
from rosetta_jit.lowering.rules import Runner
from rosetta_jit.lowering.sides import HolderSide, WireSide
from rosetta_jit.lowering.supplies import Supplies, look_up_arrays
from rosetta_jit.lowering.tagged import read_message
from rosetta_jit.lowering.values import Values
from rosetta_jit.lowering.walk import walk
from rosetta_jit.lowering.writer import Where, Writer, block
from rosetta_jit.wire.codec import Tagged

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosetta_jit.lowering.fields import HolderFields
    from rosetta_jit.lowering.typed import Rule
    from rosetta_jit.model.layout import Layout
    from rosetta_jit.wire.codec import Codec, Encoding

SCRATCH_STRIDE = 8


def lower(
    encoding: Encoding,
    layout: Layout,
    direction: Direction,
    *,
    name: str,
    rules: tuple[Rule, ...] | None = None,
    borrow: bool = False,
) -> Kernel:
    """The kernel that reads or writes messages of an encoding, or computes their size.

    Parameters
    ----------
    rules
        The rules of a mapping for this direction; None where the holder is of the wire's own type.
    borrow
        Bytes fields of the holder refer to the message instead of being copied.
    """
    writer = Writer(direction)
    attempts = encoding.attempts if direction == "decode" else (encoding.written,)
    bodies = [_body(writer, encoding, attempt, layout, rules, borrow=borrow) for attempt in attempts if attempt is not None]
    strides = (*(lane.stride for lane in layout.lanes), SCRATCH_STRIDE)
    return Kernel(name, direction, strides, tuple(bodies), tuple(writer.sites), tuple(writer.routines.values()))


def _body(writer: Writer, encoding: Encoding, attempt: Codec, layout: Layout, rules: tuple[Rule, ...] | None, *, borrow: bool) -> Block:
    with writer.nested() as body:
        writer.position = BEGIN if writer.direction != "size" else index(0)
        writer.origin = add(writer.position, encoding.origin)
        holder = root_fields(writer, layout, borrow=borrow)
        writer.expect(Compare("lt", ROW, Capacity(0)), "index", Where(), "the holder has no row for the message")
        if writer.direction == "decode":
            writer.emit(Fill(KernelPlace(0, ROW), index(layout.lanes[0].stride)))
        if rules is None:
            _own(writer, encoding, attempt, holder)
        else:
            _mapped(writer, attempt, holder, rules)
        end(writer, encoding)
        writer.emit(Return(writer.position))
    return block(body)


def _own(writer: Writer, encoding: Encoding, attempt: Codec, holder: HolderFields) -> None:
    """The holder is of the wire's own type."""
    if encoding.nested:
        descend(_nested(encoding, attempt), attempt, holder, writer)
    elif not isinstance(attempt, Tagged):
        with writer.whole():
            walk(attempt, holder, writer)
    elif writer.direction == "decode":
        rows = cursors(writer, holder.layout)
        read_message(writer, holder, attempt, END, fresh=True, depth=index(0))
        read_rows(encoding, holder, writer, rows)
    else:
        write_root(encoding, holder, attempt, writer)


def _nested(encoding: Encoding, attempt: Codec) -> Mapping[str, Codec]:
    """The codecs of recursive structs in the messages of an attempt."""
    number = next((number for number, each in enumerate(encoding.attempts) if each is attempt), 0)
    return encoding.nested[number]


def _mapped(writer: Writer, attempt: Codec, fields: HolderFields, rules: tuple[Rule, ...]) -> None:
    """Decode: find the wire's fields, then run the rules. Otherwise: lay out the message, then fill in the elements."""
    holder, found = HolderSide(writer, fields), Found()
    if writer.direction == "decode":
        wire = WireSide(writer, WireFields(writer, found))
        with writer.whole():
            walk(attempt, wire.root, writer)
        end = writer.position
        Runner(writer, wire, holder).run(rules, Values(writer, wire, {}))
        writer.position = end
        return
    values = Values(writer, holder, {})
    look_up_arrays(rules, holder, values)
    wire = WireSide(writer, WireFields(writer, found, Supplies(rules, holder, values)))
    walk(attempt, wire.root, writer)
    if writer.direction == "encode":
        Runner(writer, holder, wire).run(rules, values)
