"""Rows of types that contain themselves set nothing of the lists of which their messages bring no element.

while goes_on and pieces < limit:                       rows_texts_first = 0
  start = rows[cursor].texts.start                      ...
  first = rows[cursor].texts.count == 0 ? used : start  while goes_on and pieces < limit:
  while at < stop:                                        any_list = False
    ...                                                   if pieces > 0:
  set rows[cursor].texts.start = first                      any_list = True
  set rows[cursor].texts.count = used - first               rows_texts_first = ...
                                                          while at < stop:
                                                            case 10:
                                                              any_list = True
                                                              ...
                                                          if any_list:
                                                            set rows[cursor].texts.start = 1     of the first list: the row has any
                                                            if used > rows_texts_first:
                                                              set rows[cursor].texts.start = rows_texts_first
                                                              set rows[cursor].texts.count = used - rows_texts_first
                                                              rows_texts_first = used
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from rosetta_jit.generate.python.passes.direct import Direct, LateRow, Marked, groups_of
from rosetta_jit.generate.python.passes.late_rows import fills_outside, flagged, put, row_cleared
from rosetta_jit.generate.python.passes.mentions import blocks_within, lanes_of, places_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    Advance,
    Assign,
    Binary,
    Block,
    Compare,
    Const,
    Get,
    If,
    Let,
    Local,
    Place,
    Select,
    SetField,
    Stmt,
    Used,
    Var,
    While,
)
from rosetta_jit.kernel.passes.fold import FALSE, TRUE
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Layout
from rosetta_jit.startup.dataclass import dataclass, replace


@dataclass(frozen=True, slots=True)
class _List:
    """A list of a row: its place, its lane, the local for its first element, and the statements that find that one."""

    place: Place
    lane: int
    first: str
    start: Let
    found: Let

    def count(self) -> Place:
        return Place(self.place.lane, self.place.row, self.place.offset + 8)


@dataclass(frozen=True, slots=True)
class _Pieces:
    """The ``body`` that reads a piece of a row, and its parts around the statements of ``lists``; ``counted`` says how many were read."""

    body: Block
    counted: Local
    before: Block
    lists: tuple[_List, ...]
    between: Block
    behind: Block


def with_rows_of_pieces(body: Block, kernel: Kernel, layout: Layout, rows: Mapping[int, LateRow], direct: Direct) -> Block:
    """A decoder's body whose rows say whether they have any list; those of ``rows`` also say which groups. Notes these in ``direct``."""
    in_routines = {lane for routine in kernel.routines for stmt, _ in statements(routine.body) for lane in lanes_of(stmt)}
    for lane, _ in layout.recursive:
        pieces = _read_of(body, lane)
        if pieces is None or {lane, *(each.lane for each in pieces.lists)} & in_routines:
            continue
        offsets = tuple(each.place.offset for each in pieces.lists)
        if lane in rows and {each.offset for each in rows[lane].lists} <= {*offsets}:
            direct.late_rows[lane] = rows[lane]
        late = direct.late_rows.get(lane)
        marks = [[each.offset for each in group] for group in groups_of(late.lists)] if late is not None else []
        direct.marked[lane] = Marked(marks[0][0] if marks else offsets[0], offsets)
        changed, firsts = _changed(body, pieces, marks, layout.lanes[lane].name)
        body = _begun(body, pieces.body, changed, firsts)
    return body


def _read_of(body: Block, lane: int) -> _Pieces | None:
    """How a body reads the pieces of a row of a lane; nothing where other statements have to do with the lists of these rows."""
    pieces = (found for each in blocks_within(body) if (found := _of_pieces(each)) is not None)
    return next((each for each in pieces if each.lists[0].place.lane == lane and _are_alone(body, each)), None)


def _of_pieces(block: Block) -> _Pieces | None:
    """The pieces of a row that a block reads."""
    for begun, _, loop in zip(block, block[1:], block[2:], strict=False):
        match begun, loop:
            case Var(pieces, Const(_, 0)), While(Binary("and", _, Compare("lt", Local(_, name) as counted, _)), inner) if name == pieces:
                return _cut(inner, counted)
            case _:
                pass
    return None


def _begun(body: Block, old: Block, new: Block, firsts: tuple[str, ...]) -> Block:
    """A body with a block in place of one within it, and the variables for ``firsts`` before the loop over rows."""
    found: list[Stmt] = []
    for stmt in body:
        holds = any(each is old for each in blocks_within((stmt,)))
        found += [*(Var(first, index(0)) for first in firsts if holds), *(put((stmt,), old, new) if holds else (stmt,))]
    return tuple(found)


def _cut(block: Block, counted: Local) -> _Pieces | None:
    """A block that reads a piece of a row; nothing where it does not look up where lists start, and set them behind that."""
    begin = next((number for number, stmt in enumerate(block) if _list_of((stmt, *block[number + 1 : number + 2]))), len(block))
    lists: list[_List] = []
    while (found := _list_of(block[begin + 2 * len(lists) : begin + 2 * len(lists) + 2])) is not None:
        lists.append(found)
    wanted = tuple(stmt for each in lists for stmt in _set(each))
    rest = block[begin + len(wanted) :]
    ends = (number for number, _ in enumerate(rest) if wanted and rest[number : number + len(wanted)] == wanted)
    if (end := next(ends, None)) is None or len({each.place.lane for each in lists}) != 1:
        return None
    return _Pieces(block, counted, block[:begin], tuple(lists), rest[:end], rest[end + len(wanted) :])


def _list_of(pair: Block) -> _List | None:
    """The list of a row of which two statements find the first element."""
    match pair:
        case (
            Let(begin, Get("i64", Place() as place)) as start,
            Let(name, Select(Compare("eq", Get("i64", count), Const(_, 0)), Used(lane), Local(_, otherwise))) as first,
        ) if begin == otherwise and count == replace(place, offset=place.offset + 8):
            return _List(place, lane, name, start, first)
        case _:
            return None


def _set(each: _List) -> tuple[SetField, SetField]:
    first = Local("i64", each.first)
    return SetField(each.place, first), SetField(each.count(), Binary("sub", Used(each.lane), first))


def _are_alone(body: Block, pieces: _Pieces) -> bool:
    """Whether nothing else in a body has to do with what rows say of these lists, but that it clears each new row."""
    lane, offsets = pieces.lists[0].place.lane, {each.place.offset + behind for each in pieces.lists for behind in (0, 8)}
    parts, lanes = [stmt for stmt, _ in statements(body)], {each.lane for each in pieces.lists}
    mentions = [place for stmt in parts for place in places_of(stmt) if place.lane == lane and place.offset in offsets]
    cleared = sum(row_cleared(stmt, lane) is not None for stmt in parts)
    taken = sum(isinstance(stmt, Advance) and stmt.lane == lane for stmt in parts)
    own = 4 * len(pieces.lists) + (cleared if 0 in offsets else 0)
    return cleared == taken and len(mentions) == own and not any(fills_outside(stmt, lanes) for stmt in pieces.between)


def _changed(body: Block, pieces: _Pieces, groups: Sequence[Sequence[int]], name: str) -> tuple[Block, tuple[str, ...]]:
    """The block that reads a piece of a row, and the locals for first elements that stay from row to row: other rows lack these lists."""
    lists, between, flag = pieces.lists, pieces.between, f"any\0{name}\0list"
    own, everywhere = ([stmt.lane for stmt, _ in statements(each) if isinstance(stmt, Advance)] for each in (pieces.body, body))
    kept = tuple(each.first for each in lists if own.count(each.lane) == everywhere.count(each.lane))
    ends, flags = [SetField(replace(lists[0].place, offset=groups[0][0] if groups else lists[0].place.offset), index(1))], {flag: [*lists]}
    grouped = {offset for group in groups for offset in group}
    ends += [_ended(each, kept) for each in lists if each.place.offset not in grouped]
    for number, group in enumerate(groups):
        flags[f"{flag}\0{number}"] = some = [each for each in lists if each.place.offset in group]
        mark = SetField(replace(lists[0].place, offset=group[-1]), index(1))
        ends.append(If(Local("bool", f"{flag}\0{number}"), (mark, *(_ended(each, kept) for each in some))))
    for each, some in flags.items():
        between = tuple(flagged(stmt, {one.lane for one in some}, each) for stmt in between)
    again = (stmt for each in lists for stmt in (each.start, Assign(each.first, each.found.value)))
    begun = (Var(each.first, Used(each.lane)) for each in lists if each.first not in kept)
    changed = (
        *pieces.before,
        *begun,
        *(Var(each, FALSE) for each in flags),
        If(Compare("gt", pieces.counted, index(0)), (*(Assign(each, TRUE) for each in flags), *again)),
        *between,
        If(Local("bool", flag), tuple(ends)),
        *pieces.behind,
    )
    return changed, kept


def _ended(each: _List, kept: Collection[str]) -> If:
    """What says which elements a list of a row has, if it has any, and where those of the next row begin."""
    stays = (Assign(each.first, Used(each.lane)),) if each.first in kept else ()
    return If(Compare("gt", Used(each.lane), Local("i64", each.first)), (*_set(each), *stays))
