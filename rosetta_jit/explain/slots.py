"""The paths of a holder's fields by where they lie: the lane and the offset in its rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.model.layout import Row, Variant

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.model.layout import Layout, Slot


def slot_paths(layout: Layout) -> dict[tuple[int, int], str]:
    """The path of each field of a layout. Of several fields at one place, as the cases of a union are, the first."""
    found: dict[tuple[int, int], str] = {}
    for number, lane in enumerate(layout.lanes):
        for offset, path in _paths(lane.element, f"{lane.name}[]" if number else ""):
            found.setdefault((number, offset), path)
    return found


def _paths(slot: Slot, path: str) -> Iterator[tuple[int, str]]:
    match slot:
        case Row(members=members) | Variant(members=members):
            for member in members:
                yield from _paths(member.slot, f"{path}.{member.name}")
        case _:
            pass
    yield slot.offset, path
