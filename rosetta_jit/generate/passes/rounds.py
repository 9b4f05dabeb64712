"""Short loops that stay loops where code fills objects: each round makes one."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.generate.passes.cleared import slots_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Expect, SetField
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.passes.unroll import unroll
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Layout, Row, Span


def with_rounds(order: tuple[passes.Pass, ...], layout: Layout) -> tuple[passes.Pass, ...]:
    """The passes, of which none writes out the rounds that fill structs with lists, or with what is checked."""
    stays = _fills_structs(layout)

    def unrolled(kernel: Kernel) -> Kernel:
        return unroll(kernel, stays)

    return tuple(unrolled if each is passes.unroll else each for each in order)


def _fills_structs(layout: Layout) -> Callable[[Block], bool]:
    """Whether a block fills elements of arrays that are structs, of which it checks something, or sets where a list of one lies."""
    rows = {number: each.element for number, each in enumerate(layout.lanes) if number and isinstance(each.element, Row)}
    lists = {(number, slot.offset) for number, row in rows.items() for slot in slots_of(row) if isinstance(slot, Span)}

    def found(block: Block) -> bool:
        inner = [stmt for stmt, _ in statements(block)]
        places = [stmt.place for stmt in inner if isinstance(stmt, SetField)]
        is_checked = any(isinstance(stmt, Expect) for stmt in inner)
        return any((each.lane, each.offset) in lists or (is_checked and each.lane in rows) for each in places)

    return found
