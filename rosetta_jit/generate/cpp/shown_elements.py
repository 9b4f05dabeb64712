"""The elements of lists that an encoder in the header reads where the object has them.

They have nothing but numbers, and arrays of a fixed count of these.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.cpp.always import is_plain
from rosetta_jit.generate.cpp.spots import Spot
from rosetta_jit.model.layout import Number, Row, Slot, Span
from rosetta_jit.model.types import Array, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.walk import Walk


@dataclass(frozen=True, slots=True)
class Shown:
    """How the elements of a list are reached: the expression for each field, by its lane and offset, and the lanes of their arrays."""

    first: str
    fields: dict[tuple[int, int], str] = field(default_factory=dict[tuple[int, int], str])
    arrays: set[int] = field(default_factory=set[int])


def shown_elements(walk: Walk, type_: Array, span: Span, at: str) -> Shown | None:
    """Those of a list that is called ``at``; None if they have anything else."""
    lane, shown = walk.unit.layout.lanes[span.lane], Shown(f"rosetta_jit::detail::elements_of({at})")
    if type_.fixed is not None or lane.links is not None or not isinstance(walk.unit.schema.resolve(type_.element), Struct):
        return None
    element = Spot(f"{walk.lanes.rows(span.lane)}[$index]")
    return shown if _is_shown(walk, shown, type_.element, lane.element, element, span.lane) else None


def _is_shown(walk: Walk, shown: Shown, type_: Type, slot: Slot, spot: Spot, lane: int) -> bool:
    """Whether a part of an element is reached; ``shown`` gets how."""
    match walk.unit.schema.resolve(type_), slot:
        case _, Number(offset):
            shown.fields[lane, offset] = f"rosetta_jit::detail::got<$type>({spot.at})"
            return True
        case Array(fixed=int()) as array, Span(offset, within) if is_plain(walk, array, within):
            shown.fields[lane, offset] = f"rosetta_jit::detail::address_of<{walk.lanes.type(within)}>({spot.at})"
            shown.fields[lane, offset + 8] = f"rosetta_jit::detail::count_of({spot.at})"
            shown.arrays.add(within)
            return True
        case Struct(fields=fields) as struct, Row(unknown=None, members=members):
            inner = (walk.member_of(spot.at, name) for name in walk.names(struct))
            parts = zip(fields, members, inner, strict=True)
            return all(
                member.presence is None and walk.text("laid out", at) != "" and _is_shown(walk, shown, each.type, member.slot, at, lane)
                for each, member, at in parts
            )
        case _:
            return False
