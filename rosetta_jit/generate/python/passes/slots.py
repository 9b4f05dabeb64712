"""What is in a slot of a row: the numbers and spans of the structs and unions within it, and the lanes of its sequences."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.generate.passes.cleared import slots_of
from rosetta_jit.model.layout import Layout, Number, Row, Slot, Span, Variant


def parts_of(slot: Slot) -> Iterator[Slot]:
    """A slot and all in it, those of the cases of unions included."""
    yield slot
    if isinstance(slot, Row | Variant):
        for member in slot.members:
            yield from parts_of(member.slot)
    if isinstance(slot, Row) and slot.unknown is not None:
        yield slot.unknown


def lanes_within(slot: Slot, layout: Layout) -> set[int]:
    """The lanes of the sequences that a slot has, and of those in these."""
    found, pending = set[int](), [slot]
    while pending:
        spans = [each for each in parts_of(pending.pop()) if isinstance(each, Span) and each.lane not in found]
        found |= {each.lane for each in spans}
        pending += [layout.lanes[each.lane].element for each in spans]
    return found


def spans_of(layout: Layout, lane: int) -> dict[int, int]:
    """The lanes of the sequences that a row of a lane has, by their offsets; not those of cases of unions."""
    return {each.offset: each.lane for each in slots_of(layout.lanes[lane].element) if isinstance(each, Span)}


def offsets_within(slot: Slot) -> Iterator[int]:
    """Where the numbers lie that say all of a slot: also which fields are there, and which case."""
    for each in parts_of(slot):
        match each:
            case Number(offset, _) | Variant(offset, _):
                yield offset
            case Span(offset, _):
                yield from (offset, offset + 8)
            case Row(offset, _, words, _):
                yield from range(offset, offset + 8 * words, 8)
