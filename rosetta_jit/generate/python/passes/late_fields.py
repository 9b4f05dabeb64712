"""Fields that may not come, and need much where they do: lanes for the elements of a list, locals for a message within another.

has_joints = False                                  nothing is made for a field before the message has it
while at < end:
    match tag:
        case 26:
            if not has_joints:
                has_joints = True
                joints = _NOTHING
                joints_room = joints_used = 0
            ...
return M([...] if has_joints else [])
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping

from rosetta_jit.generate.python.passes.mentions import blocks_within, lanes_of, places_of
from rosetta_jit.generate.python.passes.slots import lanes_within, offsets_within
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Assign, Binary, Block, Const, Expr, Let, Local, Place, SetField, Stmt, Switch, Used
from rosetta_jit.kernel.passes.fold import folded
from rosetta_jit.kernel.rewrite import with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import blocks_of, statements
from rosetta_jit.model.layout import Layout, Member, Row, Span
from rosetta_jit.startup.dataclass import dataclass, replace

NOBODY = -1
"""The case of statements that stand in none."""
UNKNOWN = "unknown\0fields"
"""What unknown fields are called, as no field is."""
ENDS = 2
"""Statements behind all fields say of a list: where its rows begin, and how many there are."""


@dataclass(frozen=True, slots=True)
class LateField:
    """A field of the message, by name, with what it needs: ``lanes``, and numbers of the message's row by their ``offsets``.

    ``slot`` is that of a list, a map, or unknown fields, which are all rows of a lane, or of a message. ``cases`` are the blocks that have
    to do with the field, ``is_presence``: these say, and nothing else does, that the message has it.
    """

    name: str
    slot: Span | Row
    lanes: frozenset[int]
    offsets: frozenset[int]
    cases: frozenset[int] = frozenset()
    is_presence: bool = False


def late_fields(block: Block, kernel: Kernel, layout: Layout, known: Collection[int]) -> tuple[Block, tuple[LateField, ...]]:
    """A decoder's body that neither begins nor ends its late fields, and these; those of ``known`` lanes are objects at once."""
    if kernel.kept or not isinstance(layout.root, Row):
        return block, ()
    taken = {*known, *(lane for routine in kernel.routines for stmt, _ in statements(routine.body) for lane in lanes_of(stmt))}
    candidates = [*_candidates(layout.root, layout)]
    owners = Counter(lane for each in candidates for lane in each.lanes)
    taken |= {lane for lane, count in owners.items() if count > 1}
    wanted = [each for each in candidates if not each.lanes & taken]
    firsts = {stmt.value.lane: stmt.name for stmt in block if isinstance(stmt, Let) and isinstance(stmt.value, Used)}
    cases = _Cases(wanted)
    cases.block(_without_ends(block, wanted, firsts), NOBODY)
    found = [each for each in wanted if cases.found[each.name] and NOBODY not in cases.found[each.name]]
    found = [each for each in found if isinstance(each.slot, Row) or sum(_is_end(stmt, each.slot, firsts) for stmt in block) == ENDS]
    begun = {firsts[each.slot.lane]: index(0) for each in found if isinstance(each.slot, Span)}
    rewritten = tuple(_put(stmt, begun) for stmt in _without_ends(block, found, firsts))
    cases = _Cases(found)
    cases.block(rewritten, NOBODY)
    blocks, members = blocks_within(rewritten), {each.name: each for each in layout.root.members}
    late: list[LateField] = []
    for each in found:
        own = [block for block in blocks if id(block) in cases.found[each.name]]
        tells = isinstance(each.slot, Row) and says_presence(blocks, layout.root, members[each.name], own)
        late.append(replace(each, cases=frozenset(map(id, own)), is_presence=tells))
    return rewritten, tuple(late)


def _candidates(root: Row, layout: Layout) -> Iterator[LateField]:
    """Lists, maps and unknown fields of a message, and messages within it that may be absent."""
    spans = [(each.name, each.slot) for each in root.members if each.presence is None and isinstance(each.slot, Span)]
    spans += [(UNKNOWN, root.unknown)] if root.unknown is not None else []
    for name, span in spans:
        if layout.lanes[span.lane].links is None:
            yield LateField(name, span, frozenset(lanes_within(span, layout)), frozenset())
    for each in root.members:
        if each.presence is not None and isinstance(each.slot, Row):
            yield LateField(each.name, each.slot, frozenset(lanes_within(each.slot, layout)), frozenset(offsets_within(each.slot)))


class _Cases:
    """Finds the cases, of the outermost switch around them, in which statements have to do with fields.

    What says where a list ends has to do with all of them.
    """

    def __init__(self, wanted: list[LateField]) -> None:
        self.found = {each.name: set[int]() for each in wanted}
        self.by_lane = {lane: each.name for each in wanted for lane in each.lanes}
        self.by_offset = {offset: each.name for each in wanted for offset in each.offsets}
        self.ends = {each.slot.offset + behind: each.name for each in wanted if isinstance(each.slot, Span) for behind in (0, 8)}

    def block(self, block: Block, case: int) -> None:
        """Look at the statements of a block, which are those of a case."""
        for stmt in block:
            for lane in lanes_of(stmt) & {*self.by_lane}:
                self.found[self.by_lane[lane]].add(case)
            for offset in {place.offset for place in places_of(stmt) if place.lane == 0 and place != Place(0, index(0))}:
                if offset in self.by_offset:
                    self.found[self.by_offset[offset]].add(case)
                if offset in self.ends:
                    self.found[self.ends[offset]].add(NOBODY)
            for inner in blocks_of(stmt):
                self.block(inner, id(inner) if case == NOBODY and isinstance(stmt, Switch) else case)


def _is_end(stmt: Stmt, span: Span, firsts: Mapping[int, str]) -> bool:
    """Whether a statement says where the rows of a list begin, or how many there are."""
    if not isinstance(stmt, SetField) or span.lane not in firsts:
        return False
    first = Local("i64", firsts[span.lane])
    begin, count = Place(0, index(0), span.offset), Place(0, index(0), span.offset + 8)
    return (stmt.place, stmt.value) in ((begin, first), (count, Binary("sub", Used(span.lane), first)))


def _without_ends(block: Block, fields: list[LateField], firsts: Mapping[int, str]) -> Block:
    """A body without the statements that begin the lists of fields, of which none has a row yet, and those that end them."""
    spans = [each.slot for each in fields if isinstance(each.slot, Span)]
    begins = {firsts.get(span.lane) for span in spans}
    kept = (stmt for stmt in block if not (isinstance(stmt, Let) and stmt.name in begins))
    return tuple(stmt for stmt in kept if not any(_is_end(stmt, span, firsts) for span in spans))


def _put(stmt: Stmt, values: Mapping[str, Const]) -> Stmt:
    """A statement with numbers in place of some locals."""

    def put(expr: Expr) -> Expr:
        if isinstance(expr, Local):
            return values.get(expr.name, expr)
        match found := with_operands(expr, put):
            case Binary("sub", left, Const(_, 0)):
                return left
            case _:
                return folded(found) if found != expr else expr

    return with_blocks(with_expressions(stmt, put), lambda block: tuple(_put(each, values) for each in block))


def says_presence(blocks: list[Block], slot: Row, member: Member, setting: list[Block]) -> bool:
    """Whether a field that may be absent is said to be there where it is set, and nowhere else."""
    if member.presence is None:
        return True
    word, bit = divmod(member.presence, 64)
    place = Place(0, index(0), slot.offset + 8 * word)
    words = [stmt.value for block in blocks for stmt in block if isinstance(stmt, SetField) and stmt.place == place]
    if len(words) != 1 or not isinstance(words[0], Local):
        return False
    name = words[0].name
    told = [block for block in blocks if any(_tells(stmt, name, 1 << bit) for stmt in block)]
    return [*map(id, told)] == [*map(id, setting)]


def _tells(stmt: Stmt, name: str, bit: int) -> bool:
    match stmt:
        case Assign(of, Binary("or", Local(_, same), Const(_, bits))):
            return name == of == same and bool(int(bits) & bit)
        case Assign(of, _):
            return name == of
        case _:
            return False
