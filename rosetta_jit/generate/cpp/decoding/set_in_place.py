"""Numbers of a message that a decoder sets where the object has them: no row keeps them meanwhile.

They are those that each message has, outside of lists, unions and optional fields, and that the decoder sets in any case and never reads.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.generate.cpp.objects.always import numbers
from rosetta_jit.generate.passes.cleared import clears, settled
from rosetta_jit.generate.unit import wires_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Address, Copy, Fill, Get, HostCall, IsText, Nearest, Place, Stmt
from rosetta_jit.kernel.walk import expressions_of, extents_of, statements, subexpressions

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.objects.walk import Walk

VALUE = "$value"
"""What stands for the number in a statement that sets it."""


def straight_numbers(walk: Walk) -> dict[int, tuple[str, str]]:
    """Those numbers by their offset in the row: what the row would call each, and the statement that sets it."""
    unit = walk.unit
    kernel = unit.kernels.get("borrow")
    if walk.direction != "decode" or kernel is None or wires_of(unit):
        return {}
    offsets = _set_offsets(kernel)
    found = numbers(walk, "given_object")
    return {offset: (row, walk.text("number", spot, row=VALUE)) for offset, row, spot in found if offset in offsets}


def _set_offsets(kernel: Kernel) -> frozenset[int]:
    """The offsets of the message's row that all bodies set, and nothing reads; none where its bytes are used otherwise."""
    blocks = (*kernel.bodies, *(routine.body for routine in kernel.routines))
    nodes = [stmt for block in blocks for stmt, _ in statements(block)]
    if any(place.lane == 0 for stmt in nodes for place in _addresses(stmt)):
        return frozenset()
    parts = (part for stmt in nodes for expr in expressions_of(stmt) for part in subexpressions(expr))
    read = {part.place.offset for part in parts if isinstance(part, Get) and part.place.lane == 0}
    bodies = [{offset for offset, _ in settled(body)} for body in kernel.bodies]
    return frozenset(set[int].intersection(*bodies)) - read


def _addresses(stmt: Stmt) -> Iterator[Place]:
    """The places whose bytes a statement uses."""
    match stmt:
        case Copy(target, source, _):
            named: list[Address] = [target, source]
        case Fill(target):
            named = [] if clears(stmt) else [target]
        case HostCall():
            named = [each.address for each in extents_of(stmt)]
        case _:
            named = []
    parts = (part for expr in expressions_of(stmt) for part in subexpressions(expr))
    named += [part.address for part in parts if isinstance(part, IsText | Nearest)]
    yield from (each for each in named if isinstance(each, Place))
