"""Encoders that look at the object first, and whether there is room for the whole message, and write it then.

They stand in the header, and begin anew elsewhere where anything is wrong: nobody is told which part of the message it is.
"""

from __future__ import annotations

from collections.abc import Collection

from rosetta_jit.generate.c.positions import bound_in, difference
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.nodes import Block, Expr, Stmt
from rosetta_jit.kernel.rewrite import locals_in, substituted
from rosetta_jit.kernel.terms import END, add
from rosetta_jit.kernel.walk import expressions_of, subexpressions


def measured_first(body: Block, offsets: Collection[int]) -> Block:
    """The statements of an encoder in that order; where what it writes is longer than a sum says, room is looked at where it is needed.

    ``offsets`` are those of counts in the message's row, which are not negative.
    """
    *stmts, last = body
    first, rest = _parted(stmts)
    required = [stmt for stmt in rest if isinstance(stmt, nodes.Require)]
    values, counts = dict[str, Expr](), set[str]()
    for stmt in (stmt for stmt in first if isinstance(stmt, nodes.Let)):
        match stmt.value:
            case nodes.Get("i64", nodes.Place(0, _, offset)) if offset in offsets:
                counts.add(stmt.name)
            case value:
                values[stmt.name] = substituted(value, values)
    assert isinstance(last, nodes.Return)
    position = substituted(last.position, values)
    ends = [difference(position, substituted(add(stmt.at, stmt.size), values)) for stmt in required]
    if not ends or not all(end is not None and _is_size(end, counts) for end in ends):
        return (*first, *rest, last)
    room = nodes.Expect(nodes.Compare("ge", END, last.position), required[0].failure)
    return (*first, room, *(stmt for stmt in rest if not isinstance(stmt, nodes.Require)), last)


def _parted(stmts: Collection[Stmt]) -> tuple[list[Stmt], list[Stmt]]:
    """Locals and checks of what an object has, and the other statements with what needs these."""
    first, rest, bound = list[Stmt](), list[Stmt](), set[str]()
    for stmt in stmts:
        needs = {name for expr in expressions_of(stmt) for name in locals_in(expr)}
        is_guarded = isinstance(stmt, nodes.Let) and any(isinstance(each, nodes.Expect) for each in rest)
        if isinstance(stmt, nodes.Let | nodes.Expect) and not needs & bound and not is_guarded and not _reads_message(stmt):
            first.append(stmt)
        else:
            rest.append(stmt)
            bound |= bound_in(stmt)
    return first, rest


def _reads_message(stmt: Stmt) -> bool:
    return any(isinstance(part, nodes.Load) for expr in expressions_of(stmt) for part in subexpressions(expr))


def _is_size(expr: Expr, counts: set[str]) -> bool:
    """Whether a sum is one of counts, which are not negative."""
    match expr:
        case nodes.Binary("add" | "mul", left, right):
            return _is_size(left, counts) and _is_size(right, counts)
        case nodes.Const(_, value):
            return value >= 0
        case nodes.Local(_, name):
            return name in counts
        case _:
            return False
