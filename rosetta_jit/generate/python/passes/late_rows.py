"""Rows with many lists and maps (see `late_lists`): one that brings none of a group sets nothing of them, and its object lacks them.

rows_texts_first = 0
...
any_rows_lists = any_rows_lists_0 = any_rows_lists_1 = False
while at < stop:
    match case:
        case 10:
            any_rows_lists = True
            any_rows_lists_0 = True
            ...
if any_rows_lists:                                      without it there is a statement for each list
    rows_q[start * 42] = 1                              where the first list starts is not 0 in rows that have any
    if any_rows_lists_0:
        rows_q[start * 42 + 14] = 1                     and where the last one of a group does, in rows that have any of that
        if rows_texts_used > rows_texts_first:
            ...
            rows_texts_first = rows_texts_used

[Row(...) if rows_texts_start or rows_texts_count else _new_Row(...) for ... in _unpack_each(...)]
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Set

from rosetta_jit.generate.python.passes.direct import LateRow, groups_of
from rosetta_jit.generate.python.passes.mentions import blocks_within, lanes_of, places_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Assign, Block, Compare, Const, Fill, If, Let, Local, Place, SetField, Stmt, Switch, Used, Var
from rosetta_jit.kernel.passes.fold import FALSE, TRUE
from rosetta_jit.kernel.rewrite import with_blocks
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import blocks_of, statements
from rosetta_jit.model.layout import Layout, Span
from rosetta_jit.startup.dataclass import replace


def with_late_rows(body: Block, kernel: Kernel, layout: Layout, rows: Mapping[int, LateRow]) -> tuple[Block, dict[int, LateRow]]:
    """A decoder's body whose rows say whether they have any list, and those that do."""
    in_routines = {lane for routine in kernel.routines for stmt, _ in statements(routine.body) for lane in lanes_of(stmt)}
    found: dict[int, LateRow] = {}
    for lane, late in rows.items():
        if not {lane, *(each.lane for each in late.lists)} & in_routines:
            changed = _with_late(body, lane, late, layout.lanes[lane].name)
            found |= {lane: late} if changed is not body else {}
            body = changed
    return body, found


def _with_late(body: Block, lane: int, late: LateRow, name: str) -> Block:
    """A body with the block that fills the rows of a lane changed, if nothing else has to do with their lists."""
    offsets = {each.offset + behind for each in late.lists for behind in (0, 8)}
    mentions = [place for stmt, _ in statements(body) for place in places_of(stmt) if place.lane == lane and place.offset in offsets]
    blocks = [block for block in blocks_within(body) if any(row_cleared(stmt, lane) for stmt in block)]
    filled = _filled(blocks[0], lane, late, f"any\0{name}\0lists") if len(blocks) == 1 and len(mentions) == len(offsets) else None
    if filled is None:
        return body
    block, firsts = filled
    return (*(Var(first, index(0)) for first in firsts), *put(body, blocks[0], block))


def put(block: Block, old: Block, new: Block) -> Block:
    """A block with another one in place of one within it."""
    return new if block is old else tuple(with_blocks(stmt, lambda inner: put(inner, old, new)) for stmt in block)


def _filled(block: Block, lane: int, late: LateRow, flag: str) -> tuple[Block, tuple[str, ...]] | None:
    """The block that fills a row, with what says which lists it has in one statement; nothing where it fills lists in another way.

    Besides, the locals that say where a row's lists start: a row that has none leaves them as they are.
    """
    begin = next(number for number, stmt in enumerate(block) if row_cleared(stmt, lane))
    ends = [number for number, stmt in enumerate(block) if _list_set(stmt, lane, late.lists)]
    lanes = {each.lane for each in late.lists}
    between = block[begin + 1 : ends[0]] if len(ends) == len(late.lists) else ()
    if (
        not between
        or any(fills_outside(stmt, lanes) for stmt in between)
        or not all(isinstance(each, If) for each in block[ends[0] : ends[-1]])
    ):
        return None
    row = row_cleared(block[begin], lane)
    assert row is not None
    firsts = {
        stmt.name: stmt.value for stmt in between if isinstance(stmt, Let) and isinstance(stmt.value, Used) and stmt.value.lane in lanes
    }
    between = tuple(stmt for stmt in between if not (isinstance(stmt, Let) and stmt.name in firsts))
    told = [_with_next(block[number], firsts) for number in ends]
    flags, sets = [(flag, lanes)], list[Stmt]([SetField(replace(row, offset=late.lists[0].offset), index(1))])
    for number, group in enumerate(groups_of(late.lists)):
        flags.append((f"{flag}\0{number}", {each.lane for each in group}))
        own = (stmt for end, stmt in zip(ends, told, strict=True) if _list_set(block[end], lane, group))
        sets.append(If(Local("bool", flags[-1][0]), (SetField(replace(row, offset=group[-1].offset), index(1)), *own)))
    others = tuple(stmt for number, stmt in enumerate(block[ends[0] :], ends[0]) if number not in ends)
    for name, of in flags:
        between = tuple(flagged(stmt, of, name) for stmt in between)
    begun = (Var(name, FALSE) for name, _ in flags)
    return (*block[: begin + 1], *begun, *between, If(Local("bool", flag), tuple(sets)), *others), tuple(firsts)


def _with_next(stmt: Stmt, firsts: Mapping[str, Used]) -> Stmt:
    """A statement that says which rows a list has, and then where that of the next row starts."""
    match stmt:
        case If(Compare(_, _, Local(_, name)) as any_, then, ()) if name in firsts:
            return If(any_, (*then, Assign(name, firsts[name])), ())
        case _:
            raise AssertionError(stmt)


def row_cleared(stmt: Stmt, lane: int) -> Place | None:
    """The row of a lane that a statement clears."""
    match stmt:
        case Fill(Place(of, _, 0) as row, Const(), 0) if of == lane:
            return row
        case _:
            return None


def _list_set(stmt: Stmt, lane: int, lists: Collection[Span]) -> bool:
    """Whether a statement says which rows one of some lists of a row has, if it has any."""
    match stmt:
        case If(Compare("gt", Used(), Local()), (SetField(Place(of, _, offset)), SetField(Place())), ()):
            return of == lane and offset in {each.offset for each in lists}
        case _:
            return False


def fills_outside(stmt: Stmt, lanes: Set[int]) -> bool:
    """Whether a statement has to do with some lanes in no case of a switch, but for asking where their next row is."""
    if isinstance(stmt, Switch):
        return False
    is_first = isinstance(stmt, Let) and isinstance(stmt.value, Used)
    inner = any(fills_outside(each, lanes) for block in blocks_of(stmt) for each in block)
    return inner or (bool(lanes_of(stmt) & lanes) and not is_first)


def flagged(stmt: Stmt, lanes: Set[int], flag: str) -> Stmt:
    """A statement whose outermost switches say in which of their cases rows of some lanes come."""

    def inside(block: Block) -> Block:
        if not isinstance(stmt, Switch):
            return tuple(flagged(each, lanes, flag) for each in block)
        fills = any(lanes_of(each) & lanes for each, _ in statements(block))
        return (Assign(flag, TRUE), *block) if fills else block

    return with_blocks(stmt, inside)
