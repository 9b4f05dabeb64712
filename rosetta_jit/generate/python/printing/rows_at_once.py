"""Arrays of arrays, all of a length that a field says: one call reads all numbers, or a loop finds where the message ends.

for i in range(count):                              if 0 < m_k < 100 and at + count * m_k * 8 <= end:
    if m_k < 0:                                         rows += map(list, _unpack_each(f">{m_k}d", data[at : at + count * m_k * 8]))
        raise _Failed(6, at, (i,))                      at = at + count * m_k * 8
    if at + m_k * 8 > end:                          else:
        raise _Failed(7, at, (i,))                      for i in range(count):
    row = [*_unpack(f">{m_k}d", data, at)]                  ...
    at = at + m_k * 8
    rows.append(row)
"""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.python.passes.groups import turned
from rosetta_jit.generate.python.passes.nested_arrays import MANY
from rosetta_jit.generate.python.printing.expressions import expression
from rosetta_jit.generate.python.printing.scope import CODES, Scope
from rosetta_jit.kernel.nodes import WIDTH, Assign, Binary, Compare, Const, Copy, Expect, Expr, For, Let, Local, Place, Require, Stmt, Wire
from rosetta_jit.kernel.rewrite import locals_in, substituted
from rosetta_jit.kernel.terms import mul
from rosetta_jit.kernel.walk import bound_names
from rosetta_jit.model.layout import Layout, Number, Span
from rosetta_jit.startup.dataclass import dataclass

MOST = 100
"""Numbers of a row from which on a view of them is quicker than the struct module."""


@dataclass(frozen=True, slots=True)
class RowsAtOnce:
    """The ``condition`` under which rows are read by one call, and the ``lines`` that do so."""

    condition: str
    lines: tuple[str, ...]


def rows_at_once(scope: Scope, loop: For, layout: Layout) -> RowsAtOnce | None:
    """The rows of numbers that a loop takes from the message, one behind the other, all of a length that it has before."""
    lane = scope.direct.loops.get(loop.variable)
    if lane is None or not isinstance(layout.lanes[lane].element, Span) or isinstance(loop.count, Const):
        return None  # a constant number of rows is small
    match loop.body:
        case (
            *lets,
            Expect(Compare("ge", Local() as count, Const(_, 0))),
            Let(after, Binary("add", Local(_, at) as begin, size)),
            Require(where, least),
            fill,
            Assign(moved, Local(_, end)),
        ) if (where, least, moved, end) == (begin, size, at, after):
            length, found = _before(count, lets), _numbers(scope, fill, begin, count, size, layout)
            if found is None or length is None or not _stays(loop, length):
                return None
            return _printed(scope, scope.lanes.rows(lane), loop.count, length, at, *found)
        case _:
            return None


def _numbers(scope: Scope, fill: Stmt, begin: Expr, count: Expr, size: Expr, layout: Layout) -> tuple[str, str] | None:
    """The type and the byte order of the numbers of a row, if a statement reads all of them, and nothing else."""
    match fill:
        case For(_, rounds) if rounds == count and (found := turned(fill)) is not None and found[1] == begin:
            (place, _, type_), order = found, ">"
        case Copy(Place() as place, Wire(where), whole) if (where, whole) == (begin, size):
            slot, order = layout.lanes[place.lane].element, ""
            type_ = slot.scalar if isinstance(slot, Number) else "bool"
        case _:
            return None
    is_all = place.lane in scope.direct.whole and type_ != "bool" and size == mul(count, WIDTH[type_])
    return (type_, order) if is_all else None


def _before(count: Expr, lets: Sequence[Stmt]) -> Expr | None:
    """A number of elements without the locals that a round begins with; nothing where it begins with something else."""
    values = dict[str, Expr]()
    for stmt in lets:
        if not isinstance(stmt, Let):
            return None
        values[stmt.name] = substituted(stmt.value, values)
    return substituted(count, values)


def _stays(loop: For, length: Expr) -> bool:
    """Whether a number is the same in each round."""
    bound = {loop.variable, *(name for stmt in loop.body for name in bound_names(stmt))}
    bound |= {stmt.name for stmt in loop.body if isinstance(stmt, Assign)}
    return not locals_in(length) & bound


def _printed(scope: Scope, rows: str, count: Expr, length: Expr, at: str, type_: str, order: str) -> RowsAtOnce:
    """The rows of numbers at a local, which then says where they end."""
    begin, each = scope.locals.identifier(at), expression(scope, length)
    whole = expression(scope, mul(mul(count, length), WIDTH[type_]))
    moved, fits = f"{begin} = {begin} + {whole}", f"{begin} + {whole} <= end"
    if scope.numpy:
        numbers = f"{_array(scope, type_, order, bare(expression(scope, mul(count, length))), begin)}.reshape(-1, {bare(each)})"
        return RowsAtOnce(f"0 < {each} and {expression(scope, count)} >= {MANY} and {fits}", (f"{rows} += [*{numbers}]", moved))
    code = f'f"{order}{{{bare(each)}}}{CODES[type_]}"'
    line = f"{rows} += map(list, _unpack_each({code}, data[{begin} : {begin} + {whole}]))"
    return RowsAtOnce(f"0 < {each} < {MOST} and {fits}", (line, moved))


def _array(scope: Scope, type_: str, order: str, numbers: str, begin: str) -> str:
    """An array of numpy of so many numbers, with the byte order of this machine."""
    if order == ">":
        return f"_numbers_in(data, {scope.dtype(type_, order)}, {numbers}, {begin}).astype({scope.dtype(type_)})"
    return scope.numbers_in_message(scope.dtype(type_), numbers, begin)
