"""Short loops that stay loops where code fills objects: each round makes one."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.generate.passes.cleared import slots_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Const, Expect, For, SetField
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.passes.unroll import unroll
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Layout, Number, Row, Span

SEVERAL = 4
"""Bools that are worth to be read at once."""


def with_rounds(order: tuple[passes.Pass, ...], layout: Layout) -> tuple[passes.Pass, ...]:
    """The passes, of which none writes out the rounds that fill structs with lists, or with what is checked."""
    return _without(order, _fills_structs(layout))


def with_rounds_of_flags(order: tuple[passes.Pass, ...], layout: Layout) -> tuple[passes.Pass, ...]:
    """The passes, of which none writes out the rounds that read bools of elements of lists: code may read several of them at once."""
    return _without(order, _reads_flags(layout))


def _without(order: tuple[passes.Pass, ...], stays: Callable[[For], bool]) -> tuple[passes.Pass, ...]:
    def unrolled(kernel: Kernel) -> Kernel:
        return unroll(kernel, stays)

    return tuple(unrolled if each is passes.unroll else each for each in order)


def _reads_flags(layout: Layout) -> Callable[[For], bool]:
    """Whether a loop checks what it sets in arrays of several bools that elements of lists have."""
    rows = (each.element for each in layout.lanes[1:] if isinstance(each.element, Row))
    arrays = {slot.lane for row in rows for slot in slots_of(row) if isinstance(slot, Span)}
    elements = ((lane, layout.lanes[lane].element) for lane in arrays)
    flags = {lane for lane, element in elements if isinstance(element, Number) and element.scalar == "bool"}

    def found(loop: For) -> bool:
        inner = [stmt for stmt, _ in statements(loop.body)]
        is_checked = any(isinstance(stmt, Expect) for stmt in inner)
        is_set = any(isinstance(stmt, SetField) and stmt.place.lane in flags for stmt in inner)
        return is_checked and is_set and isinstance(loop.count, Const) and loop.count.value >= SEVERAL

    return found


def _fills_structs(layout: Layout) -> Callable[[For], bool]:
    """Whether a loop fills elements of arrays that are structs, of which it checks something, or sets where a list of one lies."""
    rows = {number: each.element for number, each in enumerate(layout.lanes) if number and isinstance(each.element, Row)}
    lists = {(number, slot.offset) for number, row in rows.items() for slot in slots_of(row) if isinstance(slot, Span)}

    def found(loop: For) -> bool:
        inner = [stmt for stmt, _ in statements(loop.body)]
        places = [stmt.place for stmt in inner if isinstance(stmt, SetField)]
        is_checked = any(isinstance(stmt, Expect) for stmt in inner)
        return any((each.lane, each.offset) in lists or (is_checked and each.lane in rows) for each in places)

    return found
