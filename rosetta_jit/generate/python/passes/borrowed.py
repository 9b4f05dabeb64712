"""Texts that a decoder copies out of the message, and reads nowhere else, stay where they are, as bytes do.

reserve lane 4, size                      set .text.start = at
let start = used 4                        set .text.count = (-1 - size)
advance lane 4, size
copy lane 4[start] <- wire[at], size
set .text.start = start
set .text.count = size
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rosetta_jit.generate.python.passes.mentions import blocks_within, changed_lane, changes, counted_lanes, places_of, readers_of
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.rewrite import locals_in, with_blocks, with_bodies
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Layout, Number
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class _Copy:
    """The statements that copy a text, those that say where it is, and its place in the message."""

    copying: tuple[nodes.Stmt, ...]
    start: nodes.SetField
    count: nodes.SetField
    at: nodes.Expr
    size: nodes.Expr


def borrowed(kernel: ir.Kernel, layout: Layout) -> ir.Kernel:
    """A kernel without the copies."""
    return with_bodies(kernel, tuple(borrowed_block(body, kernel, layout) for body in kernel.bodies))


def borrowed_block(block: nodes.Block, kernel: ir.Kernel, layout: Layout) -> nodes.Block:
    """A block of a kernel without them."""
    changing, parts = _changing(block), [stmt for stmt, _ in statements(block)]
    readers = readers_of(parts)
    mentions: dict[int, set[int]] = {}
    for stmt in (*parts, *(stmt for routine in kernel.routines for stmt, _ in statements(routine.body))):
        for lane in {each.lane for each in places_of(stmt)} | counted_lanes(stmt):
            mentions.setdefault(lane, set()).add(id(stmt))
    instead: dict[int, nodes.Block] = {}
    for lane, mentioned in mentions.items():
        if not _is_of_texts(lane, layout):
            continue
        copies = [_copy(inner, lane, readers) for inner in changing.get(lane, ())]
        found = [each for each in copies if each is not None]
        if mentioned == {id(stmt) for each in found for stmt in each.copying}:
            for each in found:
                instead |= {id(stmt): () for stmt in each.copying}
                instead[id(each.start)] = (nodes.SetField(each.start.place, each.at),)
                instead[id(each.count)] = (nodes.SetField(each.count.place, nodes.Binary("sub", index(-1), each.size)),)
    return _rewritten(block, instead) if instead else block


def _changing(block: nodes.Block) -> dict[int, list[nodes.Block]]:
    """The blocks within a block with statements that take rows of a lane, or set them, by the lane."""
    found: dict[int, list[nodes.Block]] = {}
    for inner in blocks_within(block):
        for lane in dict.fromkeys(map(changed_lane, inner)):
            if lane is not None:
                found.setdefault(lane, []).append(inner)
    return found


def _is_of_texts(lane: int, layout: Layout) -> bool:
    """Whether a lane has bytes for its rows."""
    element = layout.lanes[lane].element if 0 < lane < len(layout.lanes) else None
    return isinstance(element, Number) and element.scalar == "u8"


def _copy(block: nodes.Block, lane: int, readers: Mapping[str, set[int]]) -> _Copy | None:
    """What a block copies into a lane."""
    match [each for each in block if changes(each, lane)]:
        case (
            nodes.Reserve(_, size),
            nodes.Let(start, nodes.Used(_)),
            nodes.Advance(_, size_2),
            nodes.Copy(nodes.Place(_, nodes.Local(_, begin), 0), nodes.Wire(at), size_3) as copy,
        ) as copying if start == begin and size == size_2 == size_3:
            starts = [each for each in block if isinstance(each, nodes.SetField) and each.value == nodes.Local("i64", start)]
            if readers.get(start) != {id(copy), *map(id, starts)} or len(starts) != 1:
                return None
            place = nodes.Place(starts[0].place.lane, starts[0].place.row, starts[0].place.offset + 8)
            counts = [each for each in block if isinstance(each, nodes.SetField) and (each.place, each.value) == (place, size)]
            if len(counts) != 1 or _changes_between(block, (*copying, starts[0], counts[0]), at, size):
                return None
            return _Copy(tuple(copying), starts[0], counts[0], at, size)
        case _:
            return None


def _changes_between(block: nodes.Block, own: Sequence[nodes.Stmt], at: nodes.Expr, size: nodes.Expr) -> bool:
    """Whether a block sets a local of a text's place or size, from where the text is checked, if it is, to where it is said where it is."""
    ids = {id(each) for each in own}
    check = nodes.IsText(nodes.Wire(at), size)
    found = [number for number, each in enumerate(block) if id(each) in ids or (isinstance(each, nodes.Expect) and each.condition == check)]
    between = (stmt for stmt, _ in statements(block[min(found) : max(found) + 1]))
    return bool({each.name for each in between if isinstance(each, nodes.Assign)} & (locals_in(at) | locals_in(size)))


def _rewritten(block: nodes.Block, instead: dict[int, nodes.Block]) -> nodes.Block:
    kept = (each for stmt in block for each in instead.get(id(stmt), (stmt,)))
    return tuple(with_blocks(stmt, lambda inner: _rewritten(inner, instead)) for stmt in kept)
