"""What an encoder reads: fields of an object where they lie, and rows that are put together in the codec's memory."""

from __future__ import annotations

from string import Template
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.holder.lanes import Lanes
from rosetta_jit.generate.c.printing.functions import Attempt, Printed
from rosetta_jit.generate.c.source import run
from rosetta_jit.generate.cpp.encoding.lists_within import lists_within
from rosetta_jit.generate.cpp.encoding.messages_within import descents_of, has_lengths, visited_lanes
from rosetta_jit.generate.cpp.encoding.read_in_place import addressed_lanes, is_local
from rosetta_jit.generate.cpp.objects.always import directs
from rosetta_jit.generate.cpp.objects.lists import row_name, viewed
from rosetta_jit.generate.cpp.objects.spots import Direct, Listed, container_type
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.passes.cleared import offsets_of, slots_of
from rosetta_jit.generate.passes.work_lists import is_hidden
from rosetta_jit.generate.unit import Unit, wires_of
from rosetta_jit.kernel.nodes import Get
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.model.layout import Row
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.generate.c.language import Parts
    from rosetta_jit.generate.cpp.objects.manners import Manners

HOLDER = "std::declval<const holder &>()"


def directs_of(walk: Walk, at: str) -> list[Direct]:
    """The containers that are lanes; none where rows stay, which are the codec's."""
    found = () if wires_of(walk.unit) else directs(walk, at)
    return [each for each in found if each.lane not in walk.opened]


def addressed_in(unit: Unit, lanes: Lanes, manners: Manners) -> frozenset[int]:
    """The lanes of an encoder that are addressed."""
    return addressed_lanes(unit, frozenset(each.lane for each in directs_of(Walk(unit, lanes, manners, "encode"), "source")))


def reader(unit: Unit, lanes: Lanes, manners: Manners) -> Walk:
    """The walk of an encoder, which knows what is read where the object has it."""
    walk = Walk(unit, lanes, manners, "encode", addressed=addressed_in(unit, lanes, manners), visited=visited_lanes(unit))
    return replace(walk, within=lists_within(walk))


def viewed_by(walk: Walk, at: str = "source") -> list[Listed]:
    """The lists of ``at``, an expression for the object, that an encoder views; none where rows stay. ``walk`` is its `reader`."""
    return [] if wires_of(walk.unit) else viewed(walk, at)


def writes_apart(unit: Unit) -> bool:
    """Whether encoders need memory of their own, as what decoders have filled stays."""
    return bool(wires_of(unit)) and "encode" in unit.kernels


def encoder(unit: Unit, parts: Parts, known: dict[str, str], words: dict[str, str], directs: list[Direct], walk: Walk) -> str:
    """The encoder; ``walk`` has printed what takes an object apart."""
    lanes, encode, size = parts.lanes, parts.printed["encode"], parts.printed["size"].attempts[0]
    is_straight, memory, row = is_local(walk, encode.hidden), "written_" if writes_apart(unit) else "memory_", lanes.type(0)
    begun = (f"    holder->{lanes.rows(lane)}.{emptying(walk, lane)};" for lane in copied(parts, directs, walk))
    measure = Template(known["measure"]).substitute(no_room=str(len(encode.sites)), memory=memory) if _is_measured(unit, encode) else ""
    return Template(known["encode"]).substitute(
        words,
        row=row,
        inline="ROSETTA_JIT_INLINE " if is_straight else "",
        memory=memory,
        again="encode_any(source, &bytes[0], *size)" if is_straight else f"written(&given, {memory}->message, *{memory}, &bytes[0], *size)",
        local=f"    {row} row;" if is_straight else f"    {row} &row = {memory}->message;",
        clear="" if _is_collected(unit) else f"    {'row = {}' if is_straight else 'rosetta_jit::detail::empty(row)'};",
        reset="\n".join(begun),
        bind="\n".join(_read(lanes.rows(each.lane), each) for each in directs),
        size=run(size, "failure"),
        unsized=unset(size),
        run=run(encode.attempts[0], "failure"),
        unset=unset(encode.attempts[0]),
        tried=_tried(unit, known, row, encode.attempts[0]),
        unmeasured=Template(known["unmeasured"]).substitute(memory=memory) if has_lengths(unit) else "",
        later=Template(known["later"]).substitute(memory=memory) if has_lengths(unit) else "",
        soon=Template(known["soon"]).substitute(memory=memory) if has_lengths(unit) else "",
        known="    holder->given_lengths.known = holder->scratch[0].bytes;" if has_lengths(unit) else "",
        measure=measure,
    )


def _is_measured(unit: Unit, encode: Printed) -> bool:
    """Whether what writes reads sizes that are measured before: in memory of its own, or in the rows of messages within others."""
    nodes = (stmt for body in unit.kernels["encode"].bodies for stmt, _ in statements(body))
    parts = (part for stmt in nodes for expr in expressions_of(stmt) for part in subexpressions(expr))
    in_rows = any(isinstance(part, Get) and is_hidden(part.place, unit.layout) for part in parts)
    return bool(encode.hidden) or (in_rows and not descents_of(unit))


def _tried(unit: Unit, known: dict[str, str], row: str, attempt: Attempt) -> str:
    """The function that writes a message whose lengths are not known."""
    if not has_lengths(unit):
        return ""
    return Template(known["tried"]).substitute(name=unit.name, row=row, unset=unset(attempt), run=run(attempt, "failure"))


def unset(attempt: Attempt) -> str:
    """What a failure is at first where the function that would set it cannot fail, which not every compiler sees; else nothing."""
    return "" if "failure" in attempt.parameters else " = {0, 0, {0, 0, 0, 0}}"


def copied(parts: Parts, directs: list[Direct], walk: Walk) -> list[int]:
    """The lanes whose rows an encoder puts together in the codec's memory."""
    return copied_lanes(parts.lanes, directs, walk)


def copied_lanes(lanes: Lanes, directs: list[Direct], walk: Walk) -> list[int]:
    """The same of lanes."""
    shown = {*(each.lane for each in directs), *walk.addressed, *walk.within, *walk.visited}
    return [lane for lane in range(1, lanes.own) if lane not in shown]


def emptying(walk: Walk, lane: int) -> str:
    """What leaves a lane without rows; ``walk`` is that of the encoder, which has printed what takes an object apart."""
    return "reset()" if lane in walk.shows else "clear()"


def source_struct(unit: Unit, parts: Parts, directs: list[Direct], walk: Walk) -> str:
    """What kernels that write work on: a local of the encoder, so that a compiler need not put it into memory."""
    lanes, own = parts.lanes, copied(parts, directs, walk)
    members = [(f"rosetta_jit::detail::lane<{lanes.type(lane)}> &", lanes.rows(lane)) for lane in own]
    members += [("rosetta_jit::detail::scratch *", "scratch")] if parts.hidden else []
    of_its_own = {lanes.rows(lane) for lane in walk.opened}
    initial = [f"{name}(memory.{'gathered.' if name in of_its_own else ''}{name})" for _, name in members]
    members += [("int64_t ", "most"), ("int64_t ", "now"), ("int64_t ", "number")]
    initial += ["most(rosetta_jit::detail::most_rows(std::size_t{1} << 39))", "now(owner.now)", "number(owner.number)"]
    members += [("rosetta_jit::detail::lengths ", "given_lengths")] if has_lengths(unit) else []
    if unit.state:
        members.append(("codec::state *", "state"))
        initial.append("state(&owner.kept)")
    views = {each.direct.lane: _view(walk, each) for each in viewed_by(walk, HOLDER)}
    shown = {lane: f"shown<{lanes.type(lane)}>" for lane in range(1, lanes.own) if lane not in {*own, *walk.within, *walk.visited}} | views
    lines = [
        "/* What a message is written from: elements where an object has them, and those that are put together in the codec's memory. */",
        f"struct {unit.name}_source {{",
        *(f"    {type_}{name};" for type_, name in members),
        *(f"    rosetta_jit::detail::{kind} {lanes.rows(lane)} = {{}};" for lane, kind in shown.items()),
        "",
        f"    {unit.name}_source({unit.name}_holder &memory, codec &owner) : {', '.join(initial)} {{ static_cast<void>(memory); }}",
        "};",
        "",
    ]
    return "\n".join(lines)


def _view(walk: Walk, listed: Listed) -> str:
    """The type of a list that is viewed."""
    lane, container = listed.direct.lane, container_type(listed.direct.spot.at)
    return f"view<{walk.lanes.type(lane)}, {container}, {row_name(walk.lanes, lane)}>"


def _is_collected(unit: Unit) -> bool:
    """Whether all fields of the message's row are set from an object: what may be absent is not."""
    slots = [*slots_of(unit.layout.root)]
    may_lack = any(isinstance(each, Row) and each.unknown is not None for each in slots) or unit.layout.recursive
    return not may_lack and offsets_of(unit.layout.root) is not None


def _read(lane: str, each: Direct) -> str:
    return f"    holder->{lane}.read({each.spot.at});\n    {each.row} = {{0, holder->{lane}.used}};"
