"""An encoder's messages of types that contain themselves: instead of the work list of the kernel, a function for each lane of theirs.

def _encoded_children(element):
    ...
    return b"".join(parts)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.passes.descents import NotNested
from rosetta_jit.generate.passes.work_lists import RowBody, without_work_list
from rosetta_jit.generate.python.passes.positions import NotInParts
from rosetta_jit.kernel.nodes import Block
from rosetta_jit.model.layout import Layout

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes


def row_function(lanes: Lanes, lane: int) -> str:
    """The function that gives the bytes of a message of a lane."""
    return f"_encoded_{lanes.rows(lane)}"


def rows_in_parts(block: Block, layout: Layout) -> tuple[Block, dict[int, RowBody]]:
    """A body without its work list, and what is done for the rows of each lane; raises NotInParts where the list is another one."""
    try:
        return without_work_list(block, layout)
    except NotNested as error:
        raise NotInParts from error
