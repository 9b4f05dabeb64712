"""Encoders that find room for the whole message first, and write it then: all that says how long it is, an object has.

They stand in the header, and begin anew elsewhere where there is no room: nobody is told which part of the message lacks it.
"""

from __future__ import annotations

from collections.abc import Collection

from rosetta_jit.generate.c.positions import difference
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.nodes import Block, Expr, Stmt
from rosetta_jit.kernel.rewrite import substituted
from rosetta_jit.kernel.terms import END, add
from rosetta_jit.kernel.walk import expressions_of, subexpressions


def measured_first(body: Block, offsets: Collection[int]) -> Block:
    """The statements of an encoder in that order; the same ones where what it writes is not as long as a sum says.

    ``offsets`` are those of counts in the message's row, which are not negative.
    """
    *stmts, last = body
    required = [stmt for stmt in stmts if isinstance(stmt, nodes.Require)]
    first = [stmt for stmt in stmts if isinstance(stmt, nodes.Let | nodes.Expect)]
    rest = [stmt for stmt in stmts if not isinstance(stmt, nodes.Let | nodes.Expect | nodes.Require)]
    if not required or not isinstance(last, nodes.Return) or any(map(_reads_message, first)):
        return body
    values, counts = dict[str, Expr](), set[str]()
    for stmt in (stmt for stmt in first if isinstance(stmt, nodes.Let)):
        match stmt.value:
            case nodes.Get("i64", nodes.Place(0, _, offset)) if offset in offsets:
                counts.add(stmt.name)
            case value:
                values[stmt.name] = substituted(value, values)
    position = substituted(last.position, values)
    ends = (difference(position, substituted(add(stmt.at, stmt.size), values)) for stmt in required)
    if not all(end is not None and _is_size(end, counts) for end in ends):
        return body
    return (*first, nodes.Expect(nodes.Compare("ge", END, last.position), required[0].failure), *rest, last)


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
