"""Lists of rows that have no element: nothing is set for them, as a row is cleared when it is taken.

rows[start * 4] = first                                 if texts_used > first:
rows[start * 4 + 1] = texts_used - first                    rows[start * 4] = first
                                                            rows[start * 4 + 1] = texts_used - first
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence, Set

from rosetta_jit.generate.python.passes.mentions import assigned, places_of
from rosetta_jit.kernel.nodes import Binary, Block, Compare, Const, Expr, Fill, Get, If, Local, Place, SetField, Stmt, Used
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions


def without_empty_spans(body: Block, strides: Sequence[int], known: Collection[int]) -> Block:
    """A decoder's body that sets a list of a row where it has elements; rows of ``known`` lanes are objects at once."""
    exprs = (expr for stmt, _ in statements(body) for expr in expressions_of(stmt))
    places = (part.place for expr in exprs for part in subexpressions(expr) if isinstance(part, Get))
    sizes = {lane: stride for lane, stride in enumerate(strides) if lane and lane not in known}
    return _without(body, sizes, {(place.lane, place.offset) for place in places})


def _without(block: Block, sizes: Mapping[int, int], read: Set[tuple[int, int]]) -> Block:
    """``sizes`` are those of rows by their lanes, ``read`` the fields that statements read, by lane and offset."""
    found, cleared = list[Stmt](), set[Place]()
    for old in block:
        stmt = with_blocks(old, lambda inner: _without(inner, sizes, read))
        cleared = {row for row in cleared if not locals_in(row.row) & assigned((stmt,))} | _cleared(stmt, sizes)
        has = _has_any(found[-1], stmt, cleared) if found else None
        if has is not None and not {(place.lane, place.offset) for each in (found[-1], stmt) for place in places_of(each)} & read:
            found[-1] = If(has, (found[-1], stmt))
        else:
            found.append(stmt)
    return tuple(found)


def _cleared(stmt: Stmt, sizes: Mapping[int, int]) -> set[Place]:
    """The row that a statement clears."""
    match stmt:
        case Fill(Place(lane, _, 0) as row, Const(_, size), 0) if size == sizes.get(lane):
            return {row}
        case _:
            return set()


def _has_any(start: Stmt, count: Stmt, cleared: Set[Place]) -> Expr | None:
    """What says that a list has elements, if two statements say where in a cleared row it starts, and how many it has."""
    match start, count:
        case (
            SetField(Place(lane, row, offset), Local() as first),
            SetField(Place() as place, Binary("sub", Used() as used, begin)),
        ) if begin == first and place == Place(lane, row, offset + 8) and Place(lane, row) in cleared:
            return Compare("gt", used, first)
        case _:
            return None
