"""Arrays of a fixed count of numbers that every message has: a decoder sets their elements where the object has them, and counts none.

No row has such an array, and no lane of the codec's. The decoder must reserve its elements once, and ask for nothing but these.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.cleared import clears
from rosetta_jit.generate.cpp.lists_in_place import spans_of
from rosetta_jit.generate.unit import wires_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    Advance,
    Block,
    Capacity,
    Const,
    Copy,
    Expr,
    Fill,
    Get,
    Let,
    Local,
    Place,
    Reserve,
    SetField,
    Stmt,
    Used,
)
from rosetta_jit.kernel.passes.fold import folded
from rosetta_jit.kernel.rewrite import with_blocks, with_bodies, with_expressions, with_operands
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.model.types import Array
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.walk import Walk


@dataclass(frozen=True, slots=True)
class Fixed:
    """An array: its lane, where its span would lie in the row, how many numbers it has, and the expression for the first one."""

    lane: int
    offset: int
    count: int
    rows: str


def fixed_arrays(walk: Walk, at: str) -> list[Fixed]:
    """Those of an object, which statements call ``at``; none where rows stay."""
    unit = walk.unit
    kernel = unit.kernels.get("borrow")
    found: list[Fixed] = []
    if kernel is None or wires_of(unit):
        return found
    for type_, slot, spot in spans_of(walk, at):
        if isinstance(type_, Array) and type_.fixed and walk.is_plain(type_, slot.lane) and walk.text("laid out", spot):
            rows = walk.text("numbers", spot, row=walk.lanes.type(slot.lane), count=str(type_.fixed))
            each = Fixed(slot.lane, slot.offset, type_.fixed, rows)
            if uncounted(kernel, each) is not None:
                found.append(each)
    return found


def uncounted(kernel: Kernel, array: Fixed) -> Kernel | None:
    """A decoder that neither reserves nor counts the elements of an array; None if it cannot do without."""
    bodies = [_body(body, array) for body in kernel.bodies]
    is_apart = not any(_uses(stmt, array) for routine in kernel.routines for stmt, _ in statements(routine.body))
    return with_bodies(kernel, tuple(each for each in bodies if each is not None)) if is_apart and None not in bodies else None


def _body(body: Block, array: Fixed) -> Block | None:
    """The same of a body, whose elements begin at the lane's row 0."""
    starts, found, left_out = set[str](), list[Stmt](), list[str]()
    count = index(array.count)
    for stmt in body:
        match stmt:
            case Reserve(array.lane, of) | Advance(array.lane, of) if of == count:
                left_out.append(type(stmt).__name__)
            case Let(name, Used(array.lane)) if left_out == ["Reserve"]:
                starts.add(name)
            case SetField(Place(0, _, array.offset), Local(_, name)) if name in starts:
                left_out.append("start")
            case SetField(Place(0, _, offset), Const() as value) if offset == array.offset + 8 and value == count:
                left_out.append("count")
            case _:
                found.append(_from_row_0(stmt, starts))
    is_whole = sorted(left_out) == ["Advance", "Reserve", "count", "start"]
    is_left = any(_counts(stmt, array) for stmt, _ in statements(tuple(found)))
    return tuple(found) if is_whole and not is_left else None


def _from_row_0(stmt: Stmt, starts: set[str]) -> Stmt:
    """A statement with 0 in place of where the elements begin."""

    def replaced(expr: Expr) -> Expr:
        return index(0) if isinstance(expr, Local) and expr.name in starts else folded(with_operands(expr, replaced))

    inner = with_blocks(stmt, lambda block: tuple(_from_row_0(each, starts) for each in block))
    return with_expressions(inner, replaced)


def _counts(stmt: Stmt, array: Fixed) -> bool:
    """Whether a statement needs the array's span, or how many elements are in use."""
    span = (array.offset, array.offset + 8)
    parts = [part for expr in expressions_of(stmt) for part in subexpressions(expr)]
    asks = any(isinstance(part, Used | Capacity) and part.lane == array.lane for part in parts)
    reads = any(isinstance(part, Get) and part.place.lane == 0 and part.place.offset in span for part in parts)
    match stmt:
        case Reserve(lane) | Advance(lane):
            return lane == array.lane
        case SetField(Place(0, _, offset)) if offset in span:
            return True
        case Copy(target, source):
            return asks or reads or any(isinstance(each, Place) and each.lane == 0 for each in (target, source))
        case Fill(Place(0)):
            return not clears(stmt)
        case _:
            return asks or reads


def _uses(stmt: Stmt, array: Fixed) -> bool:
    """Whether a statement of a routine does anything with the array, or may."""
    named = [getattr(stmt, name, None) for name in ("place", "target", "source")]
    named += [getattr(part, name, None) for expr in expressions_of(stmt) for part in subexpressions(expr) for name in ("place", "address")]
    return _counts(stmt, array) or any(isinstance(each, Place) and each.lane == array.lane for each in named)
