"""Runs of numbers in protobuf: elements of one array, of a fixed size, each behind the same tag of one byte.

    element tag element tag element …

A loop that reads any field in any order takes some twenty instructions an element. Here a round takes seven: it asks whether the same tag
comes again, and nothing else. The loop ends at another tag, where the lane has no more room, and before the last element that may fit into
the message; what follows is read like any field.
"""

from __future__ import annotations

from rosetta_jit.kernel.nodes import WIDTH, Advance, Binary, Capacity, Compare, Convert, Expr, If, Load, Place, SetField, Used, While
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.codec.fields import converted, scalar_name
from rosetta_jit.lowering.codec.holder_fields import HolderFields
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.model.layout import Number as NumberSlot
from rosetta_jit.wire.codec import Entry, Number, Tagged

CROWDED = 4
"""Arrays of such numbers in a message beyond which none is read in runs: each loop takes time to compile."""
ONE_BYTE_TAGS = 1 << 7
"""Tags below this take one byte."""


def has_runs(entry: Entry, tagged: Tagged) -> bool:
    """Whether elements of an array are read in runs."""
    arrays = sum(each.label != "single" and isinstance(each.value, Number) for each in tagged.entries)
    return entry.number << 3 < ONE_BYTE_TAGS and arrays <= CROWDED


def read_run(writer: Writer, fields: HolderFields, lane: int, number: Number, tag: int, stop: Expr) -> None:
    """Append further numbers as long as they come behind the tag, and there is room for them."""
    slot = fields.layout.lanes[lane].element
    assert isinstance(slot, NumberSlot)
    width = WIDTH[scalar_name(number.scalar)]
    start, step = writer.position, width + 1
    after = writer.var("next", start)
    with writer.nested() as inside:
        fitting = Binary("div", Binary("sub", Binary("sub", stop, start), index(1)), index(step))
        room = Binary("sub", Capacity(lane), Used(lane))
        most = writer.let("most", Binary("min", fitting, room))
        run = writer.var("run", index(0))
        here = add(start, mul(run, step))
        with writer.nested() as body:
            value = Load(scalar_name(number.scalar), add(here, 1), ">" if number.order == ">" else "<")
            writer.emit(SetField(Place(lane, add(Used(lane), run)), converted(value, slot.scalar)))
            writer.assign(run, add(run, 1))
        again = Compare("eq", Convert("i64", Load("u8", here)), index(tag))
        invariant = (Compare("ge", run, index(0)), Compare("le", run, most))
        writer.emit(While(Binary("and", Compare("lt", run, most), again), block(body), invariant, run))
        writer.emit(Advance(lane, run))
        writer.assign(after, add(start, mul(run, step)))
    writer.emit(If(Compare("lt", start, stop), block(inside)))
    writer.position = after
