"""An encoder's messages of types that contain themselves: instead of the work list of the kernel, a function for each lane of theirs.

while (at_row < count):                         def _encoded_children(element):
  switch listed:                                    ...
  case 3:                                           return b"".join(parts)
    let begin = get i64 lane 3[listed].56
    ...
    expect ((at - begin) == get i64 lane 3[listed].96)

Where there is one such lane, nothing is switched.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.python.passes.positions import NotInParts
from rosetta_jit.kernel.nodes import Binary, Block, Compare, Expect, Expr, Get, Let, Local, Place, Return, Switch, While
from rosetta_jit.model.layout import Layout
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.c.lanes import Lanes


@dataclass(frozen=True, slots=True)
class RowBody:
    """The statements that write a ``row``, from the position ``begin`` to ``end``."""

    row: Expr
    begin: str
    end: Expr
    block: Block


def is_hidden(place: Place, layout: Layout) -> bool:
    """Whether a field is one of the words in which kernels keep their work list."""
    links = layout.lanes[place.lane].links if place.lane < len(layout.lanes) else None
    return links is not None and place.offset >= links


def row_function(lanes: Lanes, lane: int) -> str:
    """The function that gives the bytes of a message of a lane."""
    return f"_encoded_{lanes.rows(lane)}"


def without_work_list(block: Block, layout: Layout) -> tuple[Block, dict[int, RowBody]]:
    """A body without the loop that writes the rows below the message; and what that does, by lane."""
    match block:
        case (*own, While(_, inner), Return() as last) if layout.recursive:
            if len(layout.recursive) == 1:
                ((lane, _),) = layout.recursive
                return (*own, last), {lane: _row(inner, layout)}
            switches = [each for each in inner if isinstance(each, Switch)]
            if len(switches) == 1:
                return (*own, last), {lane: _row(case, layout) for lane, case in switches[0].cases}
            raise NotInParts
        case _:
            return block, {}


def _row(block: Block, layout: Layout) -> RowBody:
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
            raise NotInParts


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
