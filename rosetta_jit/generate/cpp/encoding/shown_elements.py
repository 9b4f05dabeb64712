"""The elements of lists that an encoder in the header reads where the object has them, also those of lists within these.

They have numbers, texts, arrays of numbers, and lists whose elements have the same.
"""

from __future__ import annotations

from string import Template

from rosetta_jit.generate.c.holder.within import Within
from rosetta_jit.generate.cpp.objects.always import is_plain
from rosetta_jit.generate.cpp.objects.spots import Spot, container_type
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.cpp.passes.few_elements import most_elements
from rosetta_jit.model.layout import Number, Row, Slot, Span
from rosetta_jit.model.types import Array, Bytes, String, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, field, replace


@dataclass(slots=True)
class Shown:
    """How the elements of a list are reached: the expression for each field, by its lane and offset, and the lanes of their arrays.

    ``counts`` are the fields that are counts, ``within`` the lists within it, and ``named`` what shows one of them by its address: name and
    type. At most ``most`` elements are few: more numbers would be copied at once. None says that elements are read one by one.
    """

    first: str
    most: int | None
    fields: dict[tuple[int, int], str] = field(default_factory=dict[tuple[int, int], str])
    counts: set[tuple[int, int]] = field(default_factory=set[tuple[int, int]])
    arrays: set[int] = field(default_factory=set[int])
    within: dict[int, Within] = field(default_factory=dict[int, Within])
    named: dict[str, str] = field(default_factory=dict[str, str])


def shown_elements(walk: Walk, type_: Array, span: Span, list_: Spot) -> Shown | None:
    """Those of a list; None if they have anything else. ``walk`` is that of an encoder, which knows what it reads where it is."""
    lane = walk.unit.layout.lanes[span.lane]
    if type_.fixed is not None or lane.links is not None or span.lane in walk.visited or not walk.text("laid out", list_):
        return None
    shown = Shown(f"rosetta_jit::detail::elements_of({list_.at})", most_elements(walk.lanes.stride(span.lane)))
    element = Spot(f"{walk.lanes.rows(span.lane)}[$index]")
    return shown if _is_shown(walk, shown, type_.element, lane.element, element, span.lane) else None


def _is_shown(walk: Walk, shown: Shown, type_: Type, slot: Slot, spot: Spot, lane: int) -> bool:
    """Whether a part of an element is reached; ``shown`` gets how."""
    match walk.unit.schema.resolve(type_), slot:
        case _, Number(offset):
            shown.fields[lane, offset] = f"rosetta_jit::detail::got<$type>({spot.at})"
            return True
        case ((String() | Bytes() | Array()) as resolved, Span(offset, own)) if _is_addressed(walk, resolved, own):
            at = walk.text("direct", spot)
            shown.fields[lane, offset] = f"rosetta_jit::detail::address_of<{walk.lanes.type(own)}>({at})"
            _count(shown, lane, offset + 8, at)
            shown.arrays.add(own)
            shown.most = shown.most if isinstance(resolved, Array) and resolved.fixed is not None else None
            return True
        case Array(element), Span(offset, own) if own in walk.within:
            _name_list(walk, shown, (lane, offset), own, walk.text("direct", spot))
            return _is_shown(walk, shown, element, walk.unit.layout.lanes[own].element, Spot("$list[$index]"), own)
        case Struct(fields=fields) as struct, Row(unknown=None, members=members):
            inner = (walk.member_of(spot.at, name) for name in walk.names(struct))
            parts = zip(fields, members, inner, strict=True)
            return all(
                member.presence is None and walk.text("laid out", at) != "" and _is_shown(walk, shown, each.type, member.slot, at, lane)
                for each, member, at in parts
            )
        case _:
            return False


def _is_addressed(walk: Walk, type_: Type, lane: int) -> bool:
    """Whether a text or an array is copied from where it is."""
    return lane in walk.addressed or (isinstance(type_, Array) and type_.fixed is not None and is_plain(walk, type_, lane))


def _name_list(walk: Walk, shown: Shown, at: tuple[int, int], own: int, list_: str) -> None:
    """Says how a list within the other one is reached, whose span is ``at`` a lane and an offset."""
    lane, offset = at
    shown.fields[lane, offset] = f"rosetta_jit::detail::address_of_list({list_})"
    _count(shown, lane, offset + 8, list_)
    name, around = f"{walk.lanes.rows(own)}_list", shown.within.get(lane)
    any_element = Template(list_).substitute(index="0", list="" if around is None else f"{around.view}::at(0)")
    shown.within[own] = replace(walk.within[own].within, view=name)
    shown.named[name] = f"rosetta_jit::detail::pointed<{container_type(any_element)}>"
    shown.most = None


def _count(shown: Shown, lane: int, offset: int, at: str) -> None:
    """Says how a count is reached."""
    shown.fields[lane, offset] = f"rosetta_jit::detail::count_of({at})"
    shown.counts.add((lane, offset))
