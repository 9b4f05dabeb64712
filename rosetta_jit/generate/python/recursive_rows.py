"""An encoder's messages of types that contain themselves: instead of the work list of the kernel, a function for each lane of theirs.

while (at_row < count):                         def _encoded_children(element):
  switch listed:                                    ...
  case 3:                                           return b"".join(parts)
    let begin = get i64 lane 3[listed].56
    ...
    expect ((at - begin) == get i64 lane 3[listed].96)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.python.positions import NotInParts
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
            switches = [each for each in inner if isinstance(each, Switch)]
            if len(switches) == 1:
                return (*own, last), {lane: _row(case, layout) for lane, case in switches[0].cases}
            raise NotInParts
        case _:
            return block, {}


def _row(case: Block, layout: Layout) -> RowBody:
    begins = [number for number, each in enumerate(case) if _is_begin(each, layout)]
    match case[begins[-1] :] if begins else ():
        case (
            Let(begin, Get(_, Place(_, row))),
            Expect(),
            *block,
            Expect(Compare("eq", Binary("sub", end, Local(_, name)), Get())),
        ) if name == begin:
            return RowBody(row, begin, end, tuple(block))
        case _:
            raise NotInParts


def _is_begin(stmt: object, layout: Layout) -> bool:
    """Whether a statement asks where a listed row begins."""
    match stmt:
        case Let(_, Get(_, Place(_, Local()) as place)):
            return is_hidden(place, layout)
        case _:
            return False
