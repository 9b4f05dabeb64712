"""Arrays of numpy in arrays, all of one length: numpy joins them, and where it cannot a loop finds the one that is different.

for i, element in enumerate(matrix):                rows = _table(_dtype_f8_be, matrix, (count, 3))
    if len(element) != 3:                           if rows is not None:
        raise _Failed(9, 0, (i,))                       parts.append(rows)
    parts.append(_whole_3d_be(*_few(element)))      else:
                                                        for i, element in enumerate(matrix):
                                                            ...
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

from rosetta_jit.kernel.nodes import Assign, Binary, Compare, Const, Convert, Copy, Expect, Expr, For, Get, Let, Local, Place, Stmt, Store
from rosetta_jit.kernel.rewrite import locals_in, substituted
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import bound_names, statements
from rosetta_jit.startup.dataclass import dataclass

MANY = 4
"""Arrays from which on numpy joins them in less time than a loop takes."""


@dataclass(frozen=True, slots=True)
class Nested:
    """What a loop writes: all numbers of a lane, in a byte order. ``lengths`` are those of the arrays, from the outermost one on."""

    lane: int
    order: str
    lengths: tuple[Expr, ...]

    def is_small(self) -> bool:
        """Whether these are a few arrays, whatever the message is, which a loop has written before numpy has joined them."""
        outer = [each.value if isinstance(each, Const) else MANY for each in self.lengths[:-1]]
        return math.prod(outer) < MANY


def nested_of(loop: For, read: Collection[str]) -> Nested | None:
    """The numbers that a loop writes, if they are many arrays and nothing else; ``read`` are the locals that are printed."""
    found = _nested(loop, read)
    return None if found is None or found.is_small() else found


def _nested(loop: For, read: Collection[str]) -> Nested | None:
    """The same of any number of arrays."""
    lets = {stmt.name: stmt.value for stmt in loop.body if isinstance(stmt, Let)}
    checks = [stmt.condition for stmt in loop.body if isinstance(stmt, Expect)]
    others = [stmt for stmt in loop.body if not isinstance(stmt, Let | Expect)]
    writes = [stmt for stmt in others if not (isinstance(stmt, Assign) and stmt.name not in read)]
    match checks:
        case [Compare("eq", Local(_, count), length)] if _row_of(lets.get(count), loop.variable) is not None:
            inner = _inner(writes, count, length, read)
        case _:
            return None
    bound = {loop.variable, *(name for stmt, _ in statements(loop.body) for name in bound_names(stmt))}
    if inner is None:
        return None
    lengths = [substituted(each, lets) for each in (length, *inner.lengths[1:])]
    return None if any(locals_in(each) & bound for each in lengths) else Nested(inner.lane, inner.order, (loop.count, *lengths))


def _inner(writes: Sequence[Stmt], count: str, length: Expr, read: Collection[str]) -> Nested | None:
    """What a round writes of its array, whose length is ``count``."""
    match writes:
        case [For(variable, rounds, body) as loop] if rounds in (Local("i64", count), length):
            found = _number(body[-1]) if body and all(isinstance(each, Let) for each in body[:-1]) else None
            if found is None:
                return _nested(loop, read)
            return Nested(found[0].lane, found[1], (length,)) if _row_of(Get("i64", found[0]), variable) is not None else None
        case [Copy(_, Place(lane, Local(), 0), _)]:
            return Nested(lane, "<", (length,))
        case [Store(), *_]:
            return _written_out(writes, length)
        case _:
            return None


def _written_out(writes: Sequence[Stmt], length: Expr) -> Nested | None:
    """Numbers that are written one by one."""
    found = [_number(stmt) for stmt in writes]
    first = found[0]
    if first is None or length != index(len(writes)) or not isinstance(first[0].row, Local):
        return None
    (lane, start), order = (first[0].lane, first[0].row), first[1]
    rows = (start, *(Binary("add", start, index(number)) for number in range(1, len(writes))))
    return Nested(lane, order, (length,)) if found == [(Place(lane, row), order) for row in rows] else None


def _number(stmt: Stmt) -> tuple[Place, str] | None:
    """The number of a lane that a statement writes, and its byte order."""
    match stmt:
        case Store(_, Get(_, place) | Convert("u8", Get("bool", place)), order):
            return place, order
        case _:
            return None


def _row_of(value: Expr | None, variable: str) -> Expr | None:
    """Where the rows begin of which a value belongs to that of a round."""
    match value:
        case Get(_, Place(_, Binary("add", Local() as start, Local(_, same)))) if same == variable:
            return start
        case _:
            return None
