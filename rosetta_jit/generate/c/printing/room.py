"""Statements of rows as lines: a lane has room for more of them, or makes it, or is full; and then more of them are in use."""

from __future__ import annotations

from string import Template
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.printing.expressions import expression
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.kernel import nodes

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes
    from rosetta_jit.generate.c.printing.scope import Scope


def rows_of(scope: Scope, stmt: nodes.Reserve | nodes.Advance) -> list[str]:
    """The lines of such a statement."""
    count = bare(expression(scope, stmt.count))
    if stmt.lane in scope.lanes.given:
        return _given_rows(scope, stmt, count)
    used = scope.used(stmt.lane)
    return [f"{used} += {count};"] if isinstance(stmt, nodes.Advance) else _reserved(scope, stmt, count, used)


def _reserved(scope: Scope, stmt: nodes.Reserve, count: str, used: str) -> list[str]:
    lanes = scope.lanes
    scope.takes("failure")
    free = f"{scope.capacity(stmt.lane)} - {used}"
    is_full = f"{used} >= {scope.capacity(stmt.lane)}" if count == "1" else f"{count} > {free}"
    missing = f"{expression(scope, stmt.count)} - ({free})"
    if stmt.lane >= lanes.own:
        missing = f"{scope.calls('bytes_of')}({missing}, {lanes.stride(stmt.lane)})"
    fails = f"return {scope.calls('full')}(failure, {stmt.lane}, {missing});"
    grown = lanes.grown(stmt.lane, missing)
    if grown is None:
        return [f"if ({is_full}) {{", f"    {fails}", "}"]
    scope.moved.add(stmt.lane)
    return [f"if ({is_full}) {{", f"    if (!{grown}) {{", f"        {fails}", "    }", f"    {moved(lanes, stmt.lane)}", "}"]


def _given_rows(scope: Scope, stmt: nodes.Reserve | nodes.Advance, count: str) -> list[str]:
    """An array that an object has gets its length; one that takes more memory than a message may ask for is refused."""
    if isinstance(stmt, nodes.Advance):
        rows = scope.rows(stmt.lane)
        scope.moved.add(stmt.lane)
        given = scope.lanes.given[stmt.lane]
        sized = Template(given.sized).substitute(count=count)
        return [f"{rows} = {sized};" if given.rows else f"{sized};"]
    scope.takes("failure")
    is_too_much = f"{count} > {scope.takes('holder')}->most"
    return [f"if ({is_too_much}) {{", f"    return {scope.calls('full')}(failure, {stmt.lane}, {count} - holder->most);", "}"]


def moved(lanes: Lanes, lane: int) -> str:
    """The statement that finds the rows of a lane which has grown."""
    return f"{lanes.rows(lane)} = {lanes.member(lane)};"
