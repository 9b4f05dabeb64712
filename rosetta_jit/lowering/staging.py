"""The wire's message in hidden lanes, for rules that cannot work on the bytes where they lie.

To unpack, the message is decoded into lanes of its own type, and the rules go on from there; to pack, the rules fill such lanes, which
are then encoded. Bytes move once more than in place, and every wire can be mapped: fields in any order, elements of any size, unions.
"""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Advance, Fill, Place, Reserve, Used
from rosetta_jit.kernel.terms import index
from rosetta_jit.lowering.codec.holder_fields import Cell, HolderFields
from rosetta_jit.lowering.writer import Writer
from rosetta_jit.model.layout import Lane, Layout, Number, behind

SCRATCH = Lane("(scratch)", 8, Number(0, "i64"))
"""What lies behind the lanes of a layout: words that a codec must remember."""


def staged_fields(writer: Writer, holder: Layout, wire: Layout) -> HolderFields:
    """The fields of an empty message of the wire, in hidden lanes; a scratch lane of its own follows them."""
    layout = behind((*holder.lanes, SCRATCH), wire)
    first = len(layout.lanes) - len(wire.lanes)
    numbers = [writer.lane(f"(wire) {number} {lane.name}", lane.stride) for number, lane in enumerate((*wire.lanes, SCRATCH))]
    assert numbers == list(range(first, first + len(numbers))), "the wire's lanes come before other hidden ones"
    lane = layout.lanes[first]
    writer.emit(Reserve(first, index(1)))
    row = writer.let("message", Used(first))
    writer.emit(Advance(first, index(1)), Fill(Place(first, row), index(lane.stride)))
    return HolderFields(writer, layout, Cell(first, row, lane.element))
