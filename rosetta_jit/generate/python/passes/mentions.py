"""What the statements of a decoder have to do with: lanes, locals."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.walk import expressions_of, extents_of, statements, subexpressions
from rosetta_jit.startup.dataclass import replace


def places_of(stmt: nodes.Stmt) -> Iterator[nodes.Place]:
    """Places of lanes that a statement has to do with."""
    match stmt:
        case nodes.SetField(place):
            yield place
        case nodes.Copy(target, source, _):
            yield from (each for each in (target, source) if isinstance(each, nodes.Place))
        case nodes.Fill(nodes.Place() as target, _, _):
            yield target
        case nodes.HostCall():
            yield from (each.address for each in extents_of(stmt) if isinstance(each.address, nodes.Place))
        case _:
            pass
    for expr in expressions_of(stmt):
        for part in subexpressions(expr):
            match part:
                case nodes.Get(_, place) | nodes.IsText(nodes.Place() as place, _) | nodes.Nearest(nodes.Place() as place, _, _):
                    yield place
                case _:
                    pass


def changed_lane(stmt: nodes.Stmt) -> int | None:
    """The lane of which a statement takes rows, or sets them."""
    match stmt:
        case nodes.Reserve(lane) | nodes.Advance(lane) | nodes.Let(_, nodes.Used(lane)):
            return lane
        case nodes.SetField(nodes.Place(lane)) | nodes.Copy(nodes.Place(lane)) | nodes.Fill(nodes.Place(lane)):
            return lane
        case _:
            return None


def changes(stmt: nodes.Stmt, lane: int) -> bool:
    """Whether a statement takes rows of a lane, or sets them."""
    return changed_lane(stmt) == lane


def readers_of(stmts: Iterable[nodes.Stmt]) -> dict[str, set[int]]:
    """The statements that read a local, by their identity."""
    found: dict[str, set[int]] = {}
    for stmt in stmts:
        for expr in expressions_of(stmt):
            for name in locals_in(expr):
                found.setdefault(name, set()).add(id(stmt))
    return found


def reads_any(stmt: nodes.Stmt, names: set[str]) -> bool:
    """Whether a statement reads one of some locals."""
    return any(names & locals_in(expr) for expr in expressions_of(stmt))


def blocks_within(block: nodes.Block) -> list[nodes.Block]:
    """A block and all within it."""
    found = [block]

    def note(inner: nodes.Block) -> nodes.Block:
        found.extend(blocks_within(inner))
        return inner

    for stmt in block:
        with_blocks(stmt, note)
    return found


def counted_lanes(stmt: nodes.Stmt) -> set[int]:
    """Lanes whose counts a statement changes or asks for."""
    found = {stmt.lane} if isinstance(stmt, nodes.Reserve | nodes.Advance) else set[int]()
    parts = (part for expr in expressions_of(stmt) for part in subexpressions(expr))
    return found | {part.lane for part in parts if isinstance(part, nodes.Used)}


def lanes_of(stmt: nodes.Stmt) -> set[int]:
    """The lanes that a statement, without the blocks within it, has to do with."""
    own = replace(stmt, invariant=()) if isinstance(stmt, nodes.While) else stmt
    return counted_lanes(own) | {place.lane for place in places_of(own)}


def reads_behind(block: nodes.Block, readers: set[int], row: nodes.Place) -> bool:
    """Whether some statements of a block read fields of its row alone, each behind the one that sets it."""
    known, seen = set[int](), set[int]()
    for outer in block:
        for stmt, _ in statements((outer,)):
            if id(stmt) in readers:
                seen.add(id(stmt))
                places = [each for each in places_of(stmt) if each.lane == row.lane]
                if any(each.row != row.row or each.offset not in known for each in places):
                    return False
        if isinstance(outer, nodes.SetField) and (outer.place.lane, outer.place.row) == (row.lane, row.row):
            known.add(outer.place.offset)
    return seen == readers


def assigned(block: nodes.Block) -> set[str]:
    """The variables that a block sets again."""
    return {stmt.name for stmt, _ in statements(block) if isinstance(stmt, nodes.Assign)}
