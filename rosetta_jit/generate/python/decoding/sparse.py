"""Messages that may lack most of their fields: the object is made first, and gets those that come as its attributes.

made = _new(M)
made.speed = made.height = 0.0                      what is not in the message has its first value
while at < end:
    ...
        made.speed = _load_d(data, at)[0]
made.joints = ... if has_joints else []             what comes in parts is set in the end
return made
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.generate.passes.cleared import slots_of
from rosetta_jit.generate.python.decoding.making import Make
from rosetta_jit.generate.python.passes.direct import Direct
from rosetta_jit.generate.python.passes.late_fields import says_presence
from rosetta_jit.generate.python.passes.mentions import blocks_within
from rosetta_jit.generate.python.printing.classes import member_names
from rosetta_jit.generate.python.printing.late_lists import set_groups
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.nodes import Block, Const, Expect, Fill, IsText, Place, SetField, Wire
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Member, Number, Row, Span
from rosetta_jit.model.types import Bytes, Field, String, Struct

OBJECT = "made"
LEAST = 8
"""Fields of a message, from which on its object is made first."""


def attributes_of(unit: Unit, body: Block, settled: frozenset[tuple[int, str]], direct: Direct) -> dict[int, str] | None:
    """The fields of the message that a body sets at once if they come, by their offset; nothing where the object is made in the end."""
    root, slot = unit.schema.types[unit.type], unit.layout.root
    assert isinstance(root, Struct)
    cleared = _cleared_again(body)
    if not isinstance(slot, Row) or cleared is None:
        return None
    always = {offset for offset, _ in settled if not _comes_in_parts(offset, unit, direct)} | _always(slot, direct)
    names = dict(zip(member_names(root), slot.members, strict=True))
    late = {name: member for name, member in names.items() if getattr(member.slot, "offset", None) not in always}
    if len(late) < LEAST:
        return None
    blocks = blocks_within(body)
    found = ((name, member, _setting(blocks, member, direct)) for name, member in late.items())
    return {
        member.slot.offset: f"{OBJECT}.{name}"
        for name, member, setting in found
        if isinstance(member.slot, Number | Span) and setting and says_presence(blocks, slot, member, setting)
        if not any(member.slot.offset in each for each in cleared)
    }


def _always(slot: Row, direct: Direct) -> set[int]:
    """Where fields lie that are objects at once, whatever the message is."""
    at_once = {*direct.whole, *direct.appended, *direct.elements, *direct.rows}
    spans = [each for each in slots_of(slot) if isinstance(each, Span)]
    known = {(0, each.offset) for each in spans} & ({*direct.texts, *direct.pieces} - direct.late)
    return {offset for _, offset in known} | {each.offset for each in spans if each.lane in at_once}


def _comes_in_parts(offset: int, unit: Unit, direct: Direct) -> bool:
    """Whether a field is a sequence of which the rows of a lane become objects in the end."""
    spans = [each for each in slots_of(unit.layout.root) if isinstance(each, Span) and each.offset == offset]
    lanes = {*direct.whole, *direct.appended, *direct.elements, *direct.rows}
    return bool(spans) and spans[0].lane not in lanes and direct.visit_at(0, offset) is None


def _cleared_again(body: Block) -> list[range] | None:
    """The parts of the message's row that are cleared where a case of a union comes; nothing if it is not cleared as a whole at first."""
    fills = [stmt for stmt, _ in statements(body) if isinstance(stmt, Fill) and isinstance(stmt.target, Place) and stmt.target.lane == 0]
    if not fills or body[0] is not fills[0] or fills[0].target != Place(0, index(0)):
        return None
    found: list[range] = []
    for fill in fills[1:]:
        match fill:
            case Fill(Place(_, _, offset), Const(_, size)):
                found.append(range(offset, offset + int(size)))
            case _:
                return None
    return found


def _setting(blocks: list[Block], member: Member, direct: Direct) -> list[Block]:
    """The blocks that set a field; none where it is not set at once."""
    slot = member.slot
    match slot:
        case Number(offset, _):
            return [block for block in blocks for stmt in block if isinstance(stmt, SetField) and stmt.place == Place(0, index(0), offset)]
        case Span(offset, _) if (0, offset) in direct.texts:
            at, size = direct.texts[0, offset]
            check = IsText(Wire(at), size)
            return [block for block in blocks for stmt in block if isinstance(stmt, Expect) and stmt.condition == check]
        case Span(offset, _) if (0, offset) in direct.pieces:
            return [block for block in blocks for stmt in block if isinstance(stmt, SetField) and stmt.place == Place(0, index(0), offset)]
        case _:
            return []


def begun(make: Make) -> list[str]:
    """The lines that make the object, with what fields have that are set at once if they come."""
    found: dict[str, list[str]] = {}
    for field, member, name in _fields(make):
        if _is_attribute(member, make):
            found.setdefault(make.first(field), []).append(f"{OBJECT}.{name}")
    return [f"{OBJECT} = _new({make.names[make.unit.type]})", *(f"{' = '.join(names)} = {value}" for value, names in found.items())]


def settings(make: Make) -> Iterator[str]:
    """The lines that set the other fields of the object, which is made."""
    unit, slot = make.unit, make.unit.layout.root
    assert isinstance(slot, Row)
    lines: list[list[str]] = [[] for _ in make.scope.lists]
    for field, member, name in _fields(make):
        if _is_attribute(member, make):
            continue
        value, there = make.member(field, member, slot, 0, "0"), ""
        match unit.schema.resolve(field.type), member.slot:
            case String() | Bytes(), Span() as span if make.scope.direct.late_at(span) is None:
                there = make.count(span)
            case _:
                pass
        line = f"{OBJECT}.{name} = {value} if {there} else {make.first(field)}" if there else f"{OBJECT}.{name} = {value}"
        group = next((number for number, lists in enumerate(make.scope.lists) if member.slot in lists), None)
        if group is None:
            yield line
        else:
            lines[group].append(line)
    if slot.unknown is not None:
        yield f"{OBJECT}.unknown_fields = {make.unknown(slot.unknown, 0, '0')}"
    if lines:
        has = [_has_any(make, number, group) for number, group in enumerate(make.scope.lists)]
        yield from set_groups(OBJECT, make.names[unit.type], [*zip(has, lines, strict=True)])


def _has_any(make: Make, number: int, group: tuple[Span, ...]) -> str:
    """What is true where any list of a group has come."""
    rows = [make.count_of(each, 0, "0") for each in group if make.scope.direct.late_at(each) is None]
    return " or ".join([*([make.scope.any_lists(number)] if len(rows) < len(group) else []), *rows])


def _fields(make: Make) -> Iterator[tuple[Field, Member, str]]:
    """The fields of the message, with their slots and attributes."""
    root, slot = make.unit.schema.types[make.unit.type], make.unit.layout.root
    assert isinstance(root, Struct)
    assert isinstance(slot, Row)
    yield from zip(root.fields, slot.members, member_names(root), strict=True)


def _is_attribute(member: Member, make: Make) -> bool:
    return getattr(member.slot, "offset", None) in (make.scope.attributes or {})
