"""The work list of messages of types that contain themselves: what encoders do for a row of it, without the list.

while (at_row < count):                         row 3   ...
  switch listed:                                        let size = get i64 lane 3[(start + i)].96
  case 3:                                               ...
    let begin = get i64 lane 3[listed].56               set lane 3[(start + i)].56 = next
    ...                                                 ...
    expect ((at - begin) == get i64 lane 3[listed].96)  from begin to at

Where there is one such lane, nothing is switched.
"""

from __future__ import annotations

from rosetta_jit.generate.passes.descents import NotNested
from rosetta_jit.kernel.nodes import Binary, Block, Compare, Expect, Expr, Get, Let, Local, Place, Return, SetField, Stmt, Switch, While
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Layout
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class RowBody:
    """The statements that write a ``row``, from the position ``begin`` to ``end``; such as measure it begin at 0."""

    row: Expr
    begin: str
    end: Expr
    block: Block


def is_hidden(place: Place, layout: Layout) -> bool:
    """Whether a field is one of the words in which kernels keep their work list."""
    links = layout.lanes[place.lane].links if place.lane < len(layout.lanes) else None
    return links is not None and place.offset >= links


def without_work_list(block: Block, layout: Layout) -> tuple[Block, dict[int, RowBody]]:
    """A body without the loop that writes the rows below the message; and what that does, by lane. Raises NotNested where it does not."""
    match block:
        case (*own, While(_, inner), Return() as last) if layout.recursive:
            return (*own, last), {lane: _written(each, layout) for lane, each in _by_lane(inner, layout).items()}
        case _:
            return block, {}


def measured_rows(block: Block, layout: Layout) -> tuple[Block, dict[int, RowBody]]:
    """What measures the message when all rows below it are, and what measures these, by lane."""
    heads = [number for number, each in enumerate(block) if isinstance(each, SetField) and each.place == Place(len(layout.lanes), index(1))]
    loops = [each for each in block[: heads[0]] if isinstance(each, While) and _sets_words(each, layout)] if heads else []
    if len(loops) != 1:
        raise NotNested
    rows = {lane: _measured(each, layout) for lane, each in _by_lane(loops[0].body, layout).items()}
    return (*_known(block[: heads[0]]), *block[heads[0] + 1 :]), rows


def _by_lane(inner: Block, layout: Layout) -> dict[int, Block]:
    """What a loop over the list does for rows of each lane."""
    if len(layout.recursive) == 1:
        ((lane, _),) = layout.recursive
        return {lane: inner}
    switches = [each for each in inner if isinstance(each, Switch)]
    if len(switches) != 1:
        raise NotNested
    return dict(switches[0].cases)


def _written(block: Block, layout: Layout) -> RowBody:
    """What writes a row of a lane, from where it begins to where its length is checked."""
    begins = [number for number, each in enumerate(block) if _is_begin(each, layout)]
    ends = [number + 1 for number, each in enumerate(block) if _is_end(each)]
    match block[begins[-1] : ends[-1]] if begins and ends else ():
        case (
            Let(begin, Get(_, Place(_, row))),
            Expect(),
            *body,
            Expect(Compare("eq", Binary("sub", end, Local(_, name)), Get())),
        ) if name == begin:
            return RowBody(row, begin, end, tuple(body))
        case _:
            raise NotNested


def _is_begin(stmt: object, layout: Layout) -> bool:
    """Whether a statement asks where a listed row begins."""
    match stmt:
        case Let(_, Get(_, Place(_, Local()) as place)):
            return is_hidden(place, layout)
        case _:
            return False


def _is_end(stmt: object) -> bool:
    """Whether a statement compares the length of what was written with that of the row."""
    match stmt:
        case Expect(Compare("eq", Binary("sub"), Get())):
            return True
        case _:
            return False


def _sets_words(loop: While, layout: Layout) -> bool:
    return any(isinstance(stmt, SetField) and is_hidden(stmt.place, layout) for stmt, _ in statements(loop.body))


def _measured(block: Block, layout: Layout) -> RowBody:
    """What measures a row of a lane, up to where its size is kept."""
    sizes = [number for number, each in enumerate(block) if isinstance(each, SetField) and is_hidden(each.place, layout)]
    last = block[sizes[-1]] if sizes else None
    if not isinstance(last, SetField):
        raise NotNested
    return RowBody(last.place.row, "", last.value, block[: sizes[-1]])


def _known(block: Block) -> list[Stmt]:
    """The locals of a block that others need alone, as what follows may read them again."""
    found, names = list[Stmt](), set[str]()
    for each in block:
        if isinstance(each, Let) and locals_in(each.value) <= names:
            found.append(each)
            names.add(each.name)
    return found
