"""Arrays of numbers that every message has: a decoder sets their elements where the object has them, and counts none.

No row has such an array, and no lane of the codec's. The decoder must reserve all of its elements at once, and ask for nothing but these.
One of a fixed length is there; another one gets its length when the decoder takes the elements into use.
"""

from __future__ import annotations

from rosetta_jit.generate.c.holder.lanes import Given
from rosetta_jit.generate.cpp.objects.always import is_plain, spans
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.passes.cleared import clears
from rosetta_jit.generate.unit import wires_of
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Expr, Stmt
from rosetta_jit.kernel.passes.fold import folded
from rosetta_jit.kernel.rewrite import with_blocks, with_bodies, with_expressions, with_operands
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.model.types import Array
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class InPlace:
    """An array: its lane, where its span would lie in the row, whether its length is fixed, and how it is reached."""

    lane: int
    offset: int
    is_fixed: bool
    given: Given


def arrays_in_place(walk: Walk, at: str) -> list[InPlace]:
    """Those of an object, which statements call ``at``; none where rows stay."""
    unit = walk.unit
    kernel = unit.kernels.get("borrow")
    found: list[InPlace] = []
    if kernel is None or wires_of(unit):
        return found
    for type_, slot, _, spot in spans(walk, at):
        if isinstance(type_, Array) and is_plain(walk, type_, slot.lane) and walk.text("laid out", spot):
            row = walk.lanes.type(slot.lane)
            given = Given(walk.text("sized", spot, row=row, count="$count"))
            if type_.fixed is not None:
                given = Given("", walk.text("numbers", spot, row=row, count=str(type_.fixed)))
            each = InPlace(slot.lane, slot.offset, type_.fixed is not None, given)
            if uncounted(kernel, each) is not None:
                found.append(each)
    return found


def uncounted(kernel: Kernel, array: InPlace) -> Kernel | None:
    """A decoder that does not count the elements of an array; None if it cannot do without."""
    bodies = [_body(body, array, kernel.strides[array.lane]) for body in kernel.bodies]
    is_apart = not any(_uses(stmt, array) for routine in kernel.routines for stmt, _ in statements(routine.body))
    return with_bodies(kernel, tuple(each for each in bodies if each is not None)) if is_apart and None not in bodies else None


def _body(body: Block, array: InPlace, stride: int) -> Block | None:
    """The same of a body, whose elements begin at the lane's row 0. Those that it copies from the message are not too many for memory."""
    starts, found, left_out, count = set[str](), list[Stmt](), list[str](), index(0)
    for number, stmt in enumerate(body):
        match stmt:
            case nodes.Reserve(array.lane, count):
                size = folded(nodes.Binary("mul", count, index(stride)))
                left_out.append("reserve")
                found += [stmt] if not array.is_fixed and not _is_copied(body[number:], array, size) else []
            case nodes.Advance(array.lane, of) if of == count:
                left_out.append("advance")
                found += [stmt] if not array.is_fixed else []
            case nodes.Let(name, nodes.Used(array.lane)) if left_out == ["reserve"]:
                starts.add(name)
            case nodes.SetField(nodes.Place(0, _, array.offset), nodes.Local(_, name)) if name in starts:
                left_out.append("start")
            case nodes.SetField(nodes.Place(0, _, offset), of) if offset == array.offset + 8 and of == count:
                left_out.append("count")
            case _:
                found.append(_from_row_0(stmt, starts))
    is_whole = sorted(left_out) == ["advance", "count", "reserve", "start"]
    returns = sum(isinstance(stmt, nodes.Return) for stmt, _ in statements(body))
    rest = (stmt for stmt, depth in statements(tuple(found)) if depth > 1 or not isinstance(stmt, nodes.Reserve | nodes.Advance))
    is_left = any(_counts(stmt, array) for stmt in rest)
    return tuple(found) if is_whole and returns == 1 and not is_left else None


def _is_copied(rest: Block, array: InPlace, size: Expr) -> bool:
    """Whether all elements are bytes of the message, which are known to be there: nothing is checked before they are copied."""
    for stmt in rest:
        inner = [each for each, _ in statements((stmt,))]
        if any(isinstance(each, nodes.Require | nodes.Call | nodes.HostCall) for each in inner):
            return False
        copies = (each for each in inner if isinstance(each, nodes.Copy) and isinstance(each.source, nodes.Wire) and each.size == size)
        if any(isinstance(each.target, nodes.Place) and each.target.lane == array.lane for each in copies):
            return True
    return False


def _from_row_0(stmt: Stmt, starts: set[str]) -> Stmt:
    """A statement with 0 in place of where the elements begin."""

    def replaced(expr: Expr) -> Expr:
        return index(0) if isinstance(expr, nodes.Local) and expr.name in starts else folded(with_operands(expr, replaced))

    inner = with_blocks(stmt, lambda block: tuple(_from_row_0(each, starts) for each in block))
    return with_expressions(inner, replaced)


def _counts(stmt: Stmt, array: InPlace) -> bool:
    """Whether a statement needs the array's span, or how many elements are in use."""
    span = (array.offset, array.offset + 8)
    parts = [part for expr in expressions_of(stmt) for part in subexpressions(expr)]
    asks = any(isinstance(part, nodes.Used | nodes.Capacity) and part.lane == array.lane for part in parts)
    reads = any(isinstance(part, nodes.Get) and part.place.lane == 0 and part.place.offset in span for part in parts)
    match stmt:
        case nodes.Reserve(lane) | nodes.Advance(lane):
            return lane == array.lane
        case nodes.SetField(nodes.Place(0, _, offset)) if offset in span:
            return True
        case nodes.Copy(target, source):
            return asks or reads or any(isinstance(each, nodes.Place) and each.lane == 0 for each in (target, source))
        case nodes.Fill(nodes.Place(0)):
            return not clears(stmt)
        case _:
            return asks or reads


def _uses(stmt: Stmt, array: InPlace) -> bool:
    """Whether a statement of a routine does anything with the array, or may."""
    named = [getattr(stmt, name, None) for name in ("place", "target", "source")]
    named += [getattr(part, name, None) for expr in expressions_of(stmt) for part in subexpressions(expr) for name in ("place", "address")]
    return _counts(stmt, array) or any(isinstance(each, nodes.Place) and each.lane == array.lane for each in named)
