"""Arrays of few arrays, whose rows a kernel writes out: each row is bytes, or numbers, that lie in the message.

set lane 1[start].0 = 8                             a_0 = data[8:11]
set lane 1[start].8 = -4
set lane 1[(start + 1)].0 = 11                      a_1 = data[11:14]
set lane 1[(start + 1)].8 = -4
"""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.kernel.nodes import Advance, Binary, Block, Const, Copy, Expr, Let, Local, Place, Reserve, SetField, Stmt, Used, Wire
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.startup.dataclass import dataclass

MOST = 16
"""Rows that become locals."""


@dataclass(frozen=True, slots=True)
class Written:
    """Where rows lie in the message, and how many bytes they have, by the place that says where they start; ``gone`` are statements
    that nothing needs.
    """

    rows: dict[Place, tuple[Expr, Expr]]
    gone: tuple[Stmt, ...]


def written_out(block: Block, start: Local, count: Expr, fills: Sequence[Stmt], inner: Sequence[Stmt], stride: int) -> Written | None:
    """The rows of an array, from ``start`` on, that a block fills by ``fills``, and the lane within them by ``inner``; None if not so.

    ``stride`` is the size of what rows have, where these are copied.
    """
    if not isinstance(count, Const) or not 0 < count.value <= MOST or len(fills) != 2 * count.value:
        return None
    here = {id(stmt) for stmt in block}
    sets = {stmt.place: stmt for stmt in fills if isinstance(stmt, SetField) and id(stmt) in here}
    found, left = Written({}, ()), [*inner]
    for number in range(int(count.value)):
        row = add(start, number)
        begin, end = (sets.get(Place(_lane_of(fills), row, offset)) for offset in (0, 8))
        place = None if begin is None or end is None else _place(begin.value, end.value, left, stride)
        if begin is None or end is None or place is None:
            return None
        at, size, own = place
        left = left[len(own) :]  # rows may share statements
        found = Written({**found.rows, begin.place: (at, size)}, (*found.gone, end, *own))
    return found if not left and {id(stmt) for stmt in inner} <= here else None


def _lane_of(fills: Sequence[Stmt]) -> int:
    return next((stmt.place.lane for stmt in fills if isinstance(stmt, SetField)), 0)


def _place(start: Expr, count: Expr, inner: Sequence[Stmt], stride: int) -> tuple[Expr, Expr, tuple[Stmt, ...]] | None:
    """Where a row lies in the message, its size, and the statements that copy it; None if it lies elsewhere."""
    match count:
        case Const(_, negative) if negative < 0 and not inner:
            return start, index(-1 - int(negative)), ()
        case Binary("sub", Const(_, -1), size) if not inner:
            return start, size, ()
        case Const():
            return _copied(start, count, inner, stride)
        case _:
            return None


def _copied(start: Expr, count: Const, inner: Sequence[Stmt], stride: int) -> tuple[Expr, Expr, tuple[Stmt, ...]] | None:
    match inner[:4]:
        case (
            Reserve(_, reserved),
            Let(name, Used()) as let,
            Advance(_, advanced),
            Copy(Place(_, Local(_, same), 0), Wire(at), size) as copy,
        ) if reserved == advanced == count and start == Local("i64", name) and name == same and size == mul(count, stride):
            return at, copy.size, (inner[0], let, inner[2], copy)
        case _:
            return None
