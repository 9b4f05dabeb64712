"""Messages of types that contain themselves, which an encoder reads where the object has them: the span in a row is the address.

Functions that call each other write them (`generate.c.visited`); where a message lies within a struct, a list, a map or a union, its class
is found by the types that these have.
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.generate.cpp.objects.spots import Spot
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.passes.descents import Descents, NotNested, descended
from rosetta_jit.generate.passes.messages_in_turn import visited_in_turn
from rosetta_jit.generate.passes.undamaged import undamaged_kernel
from rosetta_jit.generate.unit import Role, Unit, kind_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.model.layout import Layout, Row, Slot, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Map, Optional, Ref, Struct, Type, Union
from rosetta_jit.startup.dataclass import replace

HOLDER = "std::declval<const holder &>()"
PLAIN = "std::remove_cv_t<std::remove_reference_t<decltype({})>>"


def descents_of(unit: Unit) -> dict[Role, Descents]:
    """What each kernel does that writes or measures; empty where one is no descent from messages to those within them."""
    kernels = {role: kernel for role, kernel in unit.kernels.items() if kind_of(role) in ("encode", "size")}
    if not unit.layout.recursive or any(len(each.bodies) != 1 for each in kernels.values()):
        return {}
    try:
        return {role: _descents(kernel, unit.layout) for role, kernel in kernels.items()}
    except NotNested:
        return {}


def _descents(kernel: Kernel, layout: Layout) -> Descents:
    """The same of one kernel, which goes down from messages to those within them, or through a list of these."""
    try:
        return descended(undamaged_kernel(kernel).bodies[0], layout)
    except NotNested:
        return visited_in_turn(kernel, layout)


def has_lengths(unit: Unit) -> bool:
    """Whether messages within others have lengths, which may be known before these are written."""
    return any(each.lengths is not None for each in descents_of(unit).values())


def visited_lanes(unit: Unit) -> frozenset[int]:
    """The lanes of messages that an encoder reads where the object has them."""
    return frozenset(lane for each in descents_of(unit).values() for lane in each.rows)


def classes(walk: Walk, visited: frozenset[int]) -> str:
    """What reaches ``visited`` messages, which are read or written where they are; ``walk`` is that of an encoder."""
    walk = replace(walk, visited=visited)
    found = _classes(walk, Ref(walk.unit.type), walk.unit.layout.root, Spot(HOLDER), set()) if visited else ()
    lines = [f"using {walk.lanes.objects(lane)} = rosetta_jit::detail::{class_};" for lane, class_ in found]
    return "\n".join(["/* Messages within others, by the addresses that rows have of them. */", *lines, "", ""]) if lines else ""


def collectors(walk: Walk) -> str:
    """The declarations of what collects their fields."""
    heads = [f"{collecting(walk, lane)};" for lane in sorted(walk.visited)]
    return "\n".join([*heads, "", ""]) if heads else ""


def collecting(walk: Walk, lane: int) -> str:
    """The head of the function that collects the fields of a message."""
    row = walk.lanes.value_type(lane)
    name, prefix = walk.lanes.rows(lane), walk.lanes.prefix
    return f"template <class Source>\nROSETTA_JIT_INLINE void collect_{name}(const Source &source, {prefix}_source &to, {row} &row)"


def _classes(walk: Walk, type_: Type, slot: Slot, spot: Spot, found: set[int]) -> Iterator[tuple[int, str]]:
    """Those of the messages within a value, by their lanes, each once."""
    resolved = walk.unit.schema.resolve(type_)
    match resolved, slot:
        case Struct(), Row(members=members):
            for each, name, member in zip(resolved.fields, walk.names(resolved), members, strict=True):
                yield from _classes_of(walk, each.type, member.slot, walk.member_of(spot.at, name), found)
        case Union(cases=cases), Variant(members=members):
            for number, (case, member) in enumerate(zip(cases, members, strict=True), 1):
                inner = walk.case(spot, {"case": walk.named(case.name), "number": str(number)})
                yield from _classes_of(walk, case.type, member.slot, inner, found)
        case Array(element), Span(_, lane):
            list_ = PLAIN.format(walk.text("direct", spot))
            inner = Spot(f"std::declval<const rosetta_jit::detail::element_type<{list_}> &>()")
            yield from _of_lane(walk, element, lane, f"objects<{list_}>", inner, found)
        case Map(key, value), Span(_, lane):
            entry, row = map_entry(key, value), walk.unit.layout.lanes[lane].element
            assert isinstance(row, Row)
            inner = Spot(f"std::declval<const typename {PLAIN.format(spot.at)}::mapped_type &>()")
            yield from _classes(walk, entry.fields[1].type, row.members[1].slot, inner, found)
        case Struct(), Span(_, lane):
            yield from _of_lane(walk, type_, lane, f"object<{PLAIN.format(spot.at)}>", spot, found)
        case _:
            return


def _classes_of(walk: Walk, type_: Type, slot: Slot, spot: Spot, found: set[int]) -> Iterator[tuple[int, str]]:
    """The same of a field, which may be absent, or be reached by a pointer."""
    inner = type_.value if isinstance(type_, Optional) else type_
    if isinstance(slot, Span) and isinstance(walk.unit.schema.resolve(inner), Struct):
        spot = walk.value_of("link", spot)
    elif isinstance(type_, Optional):
        spot = walk.value_of("optional", spot)
    yield from _classes(walk, inner, slot, spot, found)


def _of_lane(walk: Walk, type_: Type, lane: int, class_: str, spot: Spot, found: set[int]) -> Iterator[tuple[int, str]]:
    """The class of a lane, and of those that its messages have."""
    if lane in found:
        return
    found.add(lane)
    if lane in walk.visited:
        yield lane, class_
        spot = Spot(f"std::declval<const {walk.lanes.objects(lane)}::type &>()")
    yield from _classes(walk, type_, walk.unit.layout.lanes[lane].element, spot, found)
