"""Lists whose elements a decoder sets where the object has them, and texts: no rows keep them meanwhile.

A list is *opened* where the decoder knows how many elements it has: the container gets as many, and their fields are set as they are read.
That is so where elements have fields, and each of these is a number, an array of these, a text or bytes left in the message, or such a
list, and the decoder opens a list before it sets its elements, which it never reads. Lists that lie in memory as rows do are copied
instead (`lists`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rosetta_jit.generate.c.holder.lanes import Straight
from rosetta_jit.generate.cpp.objects.always import is_plain
from rosetta_jit.generate.cpp.objects.lists import taken
from rosetta_jit.generate.cpp.objects.spots import Spot, container_type
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.cpp.passes.numbers_apart import with_numbers_apart
from rosetta_jit.generate.cpp.passes.opened import in_place
from rosetta_jit.generate.unit import wires_of
from rosetta_jit.model.layout import Number, Row, Slot, Span
from rosetta_jit.model.types import Array, Bytes, Ref, String, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, field

HOLDER = "std::declval<holder &>()"
"""An object, for types."""
SPAN = {"start": "$start", "size": "$size"}
"""What stands for where a text is in the message."""


@dataclass(frozen=True, slots=True)
class Opened:
    """A list of the message with those within it: where each is, for types, by its lane; and what sets a field, by its lane and offset.

    Or a text, which has a lane alone. ``texts`` are the lanes of lists of texts, ``numbers`` those of arrays: the type of their rows, and
    how many they are, if that is fixed; ``structs`` those of lists of structs: the type of these; ``fixed`` how many structs or texts an
    array has in any case.
    """

    at: str
    lane: int
    containers: dict[int, str] = field(default_factory=dict[int, str])
    fields: dict[tuple[int, int], Straight] = field(default_factory=dict[tuple[int, int], Straight])
    texts: set[int] = field(default_factory=set[int])
    numbers: dict[int, str] = field(default_factory=dict[int, str])
    structs: dict[int, Type] = field(default_factory=dict[int, Type])
    fixed: dict[int, int] = field(default_factory=dict[int, int])

    @property
    def lanes(self) -> frozenset[int]:
        return frozenset((self.lane, *self.containers))

    @property
    def within(self) -> frozenset[int]:
        """The lists of structs that elements have, whose numbers are set one by one: or all at once, where they lie so (`packed`)."""
        return frozenset(self.structs) - {self.lane}

    @property
    def kinds(self) -> dict[int, str]:
        """The types of lanes, by their lanes."""
        found = {lane: f"open_lane<{container_type(at)}{self._count(lane)}>" for lane, at in self.containers.items()}
        found |= {lane: f"text_lane<{container_type(self.containers[lane])}>" for lane in self.texts}
        return found | {lane: f"number_lane<{container_type(self.containers[lane])}, {row}>" for lane, row in self.numbers.items()}

    def _count(self, lane: int) -> str:
        """How many elements an array has in any case, as an argument of a template."""
        return f", {self.fixed[lane]}" if lane in self.fixed else ""


@dataclass(frozen=True, slots=True)
class _Place:
    """A value of the object: as statements reach it, as types do, and the lane that its row is in."""

    spot: Spot
    typed: Spot
    lane: int


def opened_lists(walk: Walk, at: str, typed: str = HOLDER, *, with_taken: bool = False) -> list[Opened]:
    """The lists that a decoder opens of an object, which statements call ``at`` and types ``typed``; none where rows stay.

    Those that are taken, as they lie in memory as rows do, are among them only if that is said.
    """
    unit = walk.unit
    kernel = unit.kernels.get("borrow")
    if kernel is None or wires_of(unit):
        return []
    lies = set[int]() if with_taken else {each.direct.lane for each in taken(walk, at)}
    found: list[Opened] = []
    for type_, slot, place in _spans(walk, Ref(unit.type), unit.layout.root, _Place(Spot(at), Spot(typed), 0)):
        opened = Opened(place.spot.at, slot.lane)
        if slot.lane in lies or not _value(walk, opened, type_, slot, place):
            continue
        if in_place(with_numbers_apart(kernel, unit.layout, opened.within), opened.fields) is not None:
            found.append(opened)
    return found


def row_in_place(walk: Walk, lane: int, struct: str, at: str, typed: str) -> Opened | None:
    """The same of a message within others, which is in a row of a ``lane`` by itself; None if something must stay in the row.

    Lists of further messages within it are ``walk.visited``, and nothing sets them.
    """
    opened = Opened(at, lane)
    slot = walk.unit.layout.lanes[lane].element
    return opened if _value(walk, opened, Ref(struct), slot, _Place(Spot(at), Spot(typed), lane)) else None


def messages_of(walk: Walk, lane: int, struct: str, at: str) -> Iterator[tuple[int, Span, Spot]]:
    """The lists of messages within others that an object has in any case: the lane of its row, the span in that, and the list."""
    for type_, slot, place in _spans(walk, Ref(struct), walk.unit.layout.lanes[lane].element, _Place(Spot(at), Spot(HOLDER), lane)):
        if slot.lane in walk.visited and isinstance(walk.unit.schema.resolve(type_), Array):
            yield lane, slot, Spot(walk.text("direct", place.spot))


def _spans(walk: Walk, type_: Type, slot: Slot, place: _Place) -> Iterator[tuple[Type, Span, _Place]]:
    """What has a length and is in every message."""
    resolved = walk.unit.schema.resolve(type_)
    for inner, own, at, present in _members(walk, resolved, slot, place):
        if present and isinstance(own, Span):
            yield inner, own, at
        elif present:
            yield from _spans(walk, inner, own, at)


def _members(walk: Walk, type_: Type, slot: Slot, place: _Place) -> Iterator[tuple[Type, Slot, _Place, bool]]:
    """The fields of a struct: type, slot and place of each, and whether it is always there."""
    if not isinstance(type_, Struct) or not isinstance(slot, Row):
        return
    for each, name, member in zip(type_.fields, walk.names(type_), slot.members, strict=True):
        inner = _Place(walk.member_of(place.spot.at, name), walk.member_of(place.typed.at, name), place.lane)
        yield each.type, member.slot, inner, member.presence is None


# --- what sets the fields of elements ------------------------------------------------------------------------------------------------


def _list(walk: Walk, opened: Opened, type_: Type, span: Span, place: _Place) -> bool:
    """Whether a list can be opened, as far as types say; ``opened`` gets what sets it."""
    resolved, layout = walk.unit.schema.resolve(type_), walk.unit.layout.lanes[span.lane]
    if span.lane in walk.visited:
        return True
    is_shown = walk.text("laid out", place.spot) != ""
    if not isinstance(resolved, Array) or layout.links is not None or not is_shown:
        return False
    container = walk.text("direct", place.typed)
    opened.containers[span.lane] = container
    if isinstance(layout.element, Number):
        return _numbers(walk, opened, resolved, span, place)
    if isinstance(walk.unit.schema.resolve(resolved.element), String | Bytes):
        _texts(walk, opened, resolved, span, place)
        return True
    opened.fields[place.lane, span.offset] = _opening(walk, "open", span, place)
    opened.structs[span.lane] = resolved.element
    if resolved.fixed is not None:
        opened.fixed[span.lane] = resolved.fixed
    element = f"std::declval<rosetta_jit::detail::element_type<decltype({container})> &>()"
    place = _Place(Spot(f"{walk.lanes.rows(span.lane)}[$index]"), Spot(element), span.lane)
    return _value(walk, opened, resolved.element, layout.element, place) and any(lane == span.lane for lane, _ in opened.fields)


def _texts(walk: Walk, opened: Opened, type_: Array, span: Span, place: _Place) -> None:
    """The same of texts, which an array of a fixed count of them has already."""
    rows, words = walk.lanes.rows(span.lane), SPAN
    if type_.fixed is None:
        opened.texts.add(span.lane)
        opening, kind, spot, words = "open texts", "text of a list", place.spot, words | {"lane": rows, "index": "$index"}
    else:
        opened.fixed[span.lane] = type_.fixed
        opening, kind, spot = "open", "text", Spot(f"{rows}[$index]")
    opened.fields[place.lane, span.offset] = _opening(walk, opening, span, place)
    opened.fields[span.lane, 0] = _text(walk, kind, spot, words)


def _text(walk: Walk, kind: str, spot: Spot, words: Mapping[str, str]) -> Straight:
    """What sets a text, or bytes."""
    return Straight(walk.text(kind, spot, **words), text=True, checked=walk.text(f"checked {kind}", spot, **words))


def _opening(walk: Walk, text: str, span: Span, place: _Place) -> Straight:
    """What opens a list."""
    opens = walk.text(text, place.spot, lane=walk.lanes.rows(span.lane), count="$count")
    return Straight(opens, span.lane, empty=walk.text("emptied", place.spot))


def _numbers(walk: Walk, opened: Opened, type_: Array, span: Span, place: _Place) -> bool:
    """The same of numbers that an element of a list has; those of the message itself are lanes as they are."""
    rows = walk.lanes.rows(span.lane)
    if place.lane == 0 or not is_plain(walk, type_, span.lane):
        return False
    opened.numbers[span.lane] = f"{walk.lanes.type(span.lane)}, {type_.fixed or 0}"
    opened.fields[place.lane, span.offset] = _opening(walk, "open", span, place)
    opened.fields[span.lane, 0] = Straight(walk.text("number", Spot(f"{rows}[$index]"), row="$value"), copied=True)
    return True


def _value(walk: Walk, opened: Opened, type_: Type, slot: Slot, place: _Place) -> bool:
    match walk.unit.schema.resolve(type_), slot:
        case _, Number(offset):
            opened.fields[place.lane, offset] = Straight(walk.text("number", place.spot, row="$value"))
            return True
        case ((String() | Bytes()), Span(offset)):
            opened.fields[place.lane, offset] = _text(walk, "text", place.spot, SPAN)
            return True
        case Array(), Span():
            return _list(walk, opened, type_, slot, place)
        case Struct() as struct, Row(unknown=None):
            members = [*_members(walk, struct, slot, place)]
            return all(present and _value(walk, opened, inner, own, at) for inner, own, at, present in members)
        case _:
            return False
