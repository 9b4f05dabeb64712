"""Kernels that move the numbers of a list's elements one by one, where they would copy all elements at once.

Where there are few elements, and a compiler sees the object, that takes less time than a call. How they lie in memory does not matter.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import cast

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Copy, Expr, Local, Place, Scalar, Stmt, Wire
from rosetta_jit.kernel.rewrite import with_blocks, with_bodies
from rosetta_jit.kernel.terms import add, mul
from rosetta_jit.model.layout import Layout, Number, Row, Slot
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class _Rows:
    """Rows that have numbers alone: how many bytes each has, and its numbers by where they lie."""

    size: int
    numbers: tuple[tuple[int, Scalar], ...]

    @property
    def is_whole(self) -> bool:
        """Whether there is nothing else in a row."""
        return bool(self.numbers) and sum(nodes.WIDTH[type_] for _, type_ in self.numbers) == self.size


def with_numbers_apart(kernel: Kernel, layout: Layout, lanes: Collection[int] | None = None) -> Kernel:
    """The same of all lists of structs that have numbers alone, without gaps, or of those of some ``lanes``."""
    known = range(1, len(layout.lanes)) if lanes is None else lanes
    found = {lane: _Rows(kernel.strides[lane], tuple(_numbers(layout.lanes[lane].element))) for lane in known}
    whole = {lane: each for lane, each in found.items() if each.is_whole}
    return with_bodies(kernel, tuple(_apart(body, whole) for body in kernel.bodies)) if whole else kernel


def _numbers(slot: Slot) -> Iterator[tuple[int, Scalar]]:
    """The numbers of a struct; none are counted of what it has besides."""
    for member in slot.members if isinstance(slot, Row) else ():
        if isinstance(member.slot, Number):
            yield member.slot.offset, cast("Scalar", member.slot.scalar)
        else:
            yield from _numbers(member.slot)


def _apart(block: Block, rows: Mapping[int, _Rows]) -> Block:
    return tuple(with_blocks(_stmt(stmt, rows), lambda inner: _apart(inner, rows)) for stmt in block)


def _stmt(stmt: Stmt, rows: Mapping[int, _Rows]) -> Stmt:
    """A copy as a loop, which needs no condition around it."""
    match stmt:
        case nodes.If(_, (Copy() as copy,), ()):
            return _loop(copy, rows) or stmt
        case Copy():
            return _loop(stmt, rows) or stmt
        case _:
            return stmt


def _loop(copy: Copy, rows: Mapping[int, _Rows]) -> nodes.For | None:
    """The loop that a copy between a list and the message stands for."""
    match copy.target, copy.source, copy.size:
        case (Place(lane, row, 0), Wire(at), nodes.Binary("mul", count, nodes.Const(_, size))) if lane in rows and size == rows[lane].size:
            make = _read
        case (Wire(at), Place(lane, row, 0), nodes.Binary("mul", count, nodes.Const(_, size))) if lane in rows and size == rows[lane].size:
            make = _written
        case _:
            return None
    number, item = Local("i64", f"i {lane}"), Local("i64", f"item {lane}")  # no local of a kernel is called so
    numbers = (make(Place(lane, add(row, number), offset), type_, add(item, offset)) for offset, type_ in rows[lane].numbers)
    return nodes.For(number.name, count, (nodes.Let(item.name, add(mul(number, rows[lane].size), at)), *numbers))


def _read(place: Place, type_: Scalar, at: Expr) -> Stmt:
    return nodes.SetField(place, nodes.Load(type_, at, "<"))


def _written(place: Place, type_: Scalar, at: Expr) -> Stmt:
    return nodes.Store(at, nodes.Get(type_, place), "<")
