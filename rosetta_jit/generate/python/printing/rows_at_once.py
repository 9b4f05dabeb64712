"""Arrays of arrays or bytes, all of a length that a field says: one call reads all, or a loop finds where the message ends.

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
from rosetta_jit.generate.python.printing.reading import SOME
from rosetta_jit.generate.python.printing.scope import CODES, Scope
from rosetta_jit.kernel.nodes import (
    WIDTH,
    Assign,
    Binary,
    Compare,
    Const,
    Copy,
    Expect,
    Expr,
    For,
    Let,
    Local,
    Place,
    Require,
    Reserve,
    SetField,
    Stmt,
    Var,
    Wire,
)
from rosetta_jit.kernel.rewrite import locals_in, substituted
from rosetta_jit.kernel.terms import index, mul
from rosetta_jit.kernel.walk import bound_names
from rosetta_jit.model.layout import Layout, Number, Span
from rosetta_jit.startup.dataclass import dataclass

SEVERAL = 3
"""Rows of several bytes each from which on one call reads them in less time than a loop takes."""


@dataclass(frozen=True, slots=True)
class RowsAtOnce:
    """The ``condition`` under which rows are read by one call, and the ``lines`` that do so."""

    condition: str
    lines: tuple[str, ...]


def rows_at_once(scope: Scope, loop: For, layout: Layout) -> RowsAtOnce | None:
    """The rows of numbers or bytes that a loop takes from the message, one behind the other, all of a length that it has before."""
    lane = scope.direct.loops.get(loop.variable)
    if lane is None or not isinstance(layout.lanes[lane].element, Span) or isinstance(loop.count, Const):
        return None  # a constant number of rows is small
    match loop.body:
        case (
            *lets,
            Expect(Compare("ge", Local() as count, Const(_, 0))),
            Let(after, Binary("add", Local(_, at) as begin, size)),
            Require(where, least),
            For() | Copy() as fill,
            Assign(moved, Local(_, end)),
        ) if (where, least, moved, end) == (begin, size, at, after):
            length, found = _before(count, lets), _numbers(scope, fill, begin, count, size, layout)
            if found is None or length is None or not _stays(loop, length):
                return None
            return _printed(scope, scope.lanes.rows(lane), loop.count, length, at, *found)
        case (*_, Assign(at, _)) if (pieces := _pieces(scope, loop.body)) is not None:
            if pieces.at != at or not _stays(loop, pieces.size) or not _stays(loop, pieces.number):
                return None
            return _printed_pieces(scope, scope.lanes.rows(lane), loop.count, pieces)
        case _:
            return None


@dataclass(frozen=True, slots=True)
class _Pieces:
    """A row of bytes of one ``size`` each, from the local ``at`` on: ``number`` of them, or one that is no list."""

    at: str
    size: Expr
    number: Expr
    is_list: bool


def _pieces(scope: Scope, body: Sequence[Stmt]) -> _Pieces | None:
    """The bytes that a round takes, if it does nothing else."""
    stmts = [each for each in body if not isinstance(each, Reserve)]
    match stmts:
        case [
            *lets,
            Let(after, Binary("add", Local(_, at) as begin, size)),
            Require(where, least),
            fill,
            Assign(moved, Local(_, end)),
        ] if (where, least, moved, end) == (begin, size, at, after):
            number, of_one = _filled(scope, fill, begin, size)
            length = _before(of_one, [each for each in lets if not _is_sign_of(each, of_one)])
            return _Pieces(at, length, number, isinstance(fill, For)) if number is not None and length is not None else None
        case [Var(inner, Local(_, at)), For(_, number, within), Assign(moved, Local(_, end))] if (moved, end) == (at, inner):
            found = _pieces(scope, within)
            return None if found is None or found.at != inner or found.is_list else _Pieces(at, found.size, number, is_list=True)
        case _:
            return None


def _filled(scope: Scope, fill: Stmt, begin: Expr, size: Expr) -> tuple[Expr | None, Expr]:
    """How many objects of bytes, and of which size a statement takes from a part of the message; None where it does something else."""

    def is_piece(stmt: SetField, at: Expr, length: Expr) -> bool:
        lane = stmt.place.lane
        return lane in scope.direct.listed and scope.direct.pieces.get((lane, stmt.place.offset)) == (at, length)

    match fill:
        case SetField() if is_piece(fill, begin, size):
            return index(1), size
        case For(
            variable, number, (Let(item, Binary("add", first, Binary("mul", Local(_, round_), Const() as length))), SetField() as put)
        ):
            is_all = first == begin and round_ == variable and size == mul(number, length)
            return (number, length) if is_all and is_piece(put, Local("i64", item), length) else (None, size)
        case _:
            return None, size


def _is_sign_of(stmt: Stmt, value: Expr) -> bool:
    """Whether a statement checks that a number is not negative, as one is not by which rows are read at once."""
    return isinstance(stmt, Expect) and stmt.condition == Compare("ge", value, index(0))


def _printed_pieces(scope: Scope, rows: str, count: Expr, pieces: _Pieces) -> RowsAtOnce:
    """Rows of bytes at a local, which then says where they end."""
    begin, each, number = scope.locals.identifier(pieces.at), expression(scope, pieces.size), expression(scope, pieces.number)
    whole = expression(scope, mul(mul(count, pieces.number), pieces.size))
    rounds, moved, fits = expression(scope, count), f"{begin} = {begin} + {whole}", f"{begin} + {whole} <= end"
    if not pieces.is_list:
        line = f"{rows} += _pieces(data, {begin}, {bare(each)}, {bare(rounds)})"
        return RowsAtOnce(f"{rounds} >= {MANY} and 0 < {each} and {fits}", (line, moved))
    is_some = "" if isinstance(pieces.size, Const) else f"0 < {each} and "
    is_some += "" if isinstance(pieces.number, Const) else f"0 < {number} < {SOME} and "
    code = f'"{each}s" * {number}' if isinstance(pieces.size, Const) else f'f"{{{bare(each)}}}s" * {number}'
    line = f"{rows} += map(list, _unpack_each({code}, data[{begin} : {begin} + {whole}]))"
    return RowsAtOnce(f"{rounds} >= {SEVERAL} and {is_some}{fits}", (line, moved))


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
    return RowsAtOnce(f"0 < {each} < {SOME} and {fits}", (line, moved))


def _array(scope: Scope, type_: str, order: str, numbers: str, begin: str) -> str:
    """An array of numpy of so many numbers, with the byte order of this machine."""
    if order == ">":
        return f"_numbers_in(data, {scope.dtype(type_, order)}, {numbers}, {begin}).astype({scope.dtype(type_)})"
    return scope.numbers_in_message(scope.dtype(type_), numbers, begin)
