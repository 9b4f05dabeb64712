"""Loops of C++ over arrays of bools that are a byte each, of which functions of the shared header do many rounds at once.

row[i] = bytes[at + i] != 0, if it is 0 or 1        read_flags: as many as it is sure of; the loop does the rest, and says what is wrong
bytes[at + i] = row[i] != 0                         copy_flags: all of them
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.c.printing.expressions import expression, list_within
from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Expect, Expr, For, Get, Let, Load, Local, Place, SetField, Store
from rosetta_jit.kernel.passes.fold import folded
from rosetta_jit.kernel.rewrite import locals_in, substituted
from rosetta_jit.kernel.terms import index
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.c.printing.scope import Scope


@dataclass(frozen=True, slots=True)
class Flags:
    """Bools of the message from ``at`` on, and rows of a lane from ``row`` on; ``is_read`` says which become the others."""

    at: Expr
    lane: int
    row: Expr
    is_read: bool


def flags_of(loop: For) -> Flags | None:
    """What a loop does, if it is one of these."""
    first = {loop.variable: index(0)}
    match loop.body:
        case (
            Let(item, at),
            Let(code, Convert("i64", Load("u8" | "i8", Local(_, from_)))),
            Expect(Binary("and", Compare("ge", Local(_, one), Const(_, 0)), Compare("le", Local(_, other), Const(_, 1)))),
            SetField(Place(lane, row, 0), Compare("ne", Local(_, value), Const(_, 0))),
        ) if from_ == item and {one, other, value} == {code}:
            found = Flags(at, lane, row, is_read=True)
        case (
            Let(item, at),
            Let(code, Convert("i64", Get("bool", Place(lane, row, 0)))),
            Store(Local(_, to), Convert("u8" | "i8", Local(_, value))),
        ) if to == item and value == code:
            found = Flags(at, lane, row, is_read=False)
        case _:
            return None
    if not all(_is_behind(each, loop.variable) for each in (found.at, found.row)):
        return None
    at, row = (folded(substituted(each, first)) for each in (found.at, found.row))
    return Flags(at, found.lane, row, found.is_read)


def _is_behind(expr: Expr, variable: str) -> bool:
    """Whether an expression grows with a variable, one by one."""
    match expr:
        case Local(_, name):
            return name == variable
        case Binary("add", one, other):
            return any(_is_behind(each, variable) and variable not in locals_in(rest) for each, rest in ((one, other), (other, one)))
        case _:
            return False


def flags_done(scope: Scope, flags: Flags, count: str) -> str | None:
    """The expression or statement that does rounds of such a loop; None where rows are not bytes one behind the other."""
    lanes, lane = scope.lanes, flags.lane
    if lane in lanes.within and not flags.is_read:
        view = ", ".join(list_within(scope, lane, flags.row))
        return f"rosetta_jit::detail::copy_flags_of({scope.takes('bytes')} + {expression(scope, flags.at)}, {view}, {count})"
    if lanes.dialect != "c++" or lane in lanes.addressed | lanes.viewed or lanes.stride(lane) != 1:
        return None
    rows = f"{scope.rows(lane)} + {expression(scope, flags.row)}"
    message = f"{scope.takes('bytes')} + {expression(scope, flags.at)}"
    if lane in lanes.opened:
        elements = f"{scope.rows(lane)}, {expression(scope, flags.row)}"
        return f"rosetta_jit::detail::read_flags_of({elements}, {message}, {count})" if flags.is_read else None
    name, target, source = ("read_flags", rows, message) if flags.is_read else ("copy_flags", message, rows)
    return f"rosetta_jit::detail::{name}({target}, {source}, {count})"
