"""The parts of statements and expressions of a kernel, for every walk over them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from operator import attrgetter
from typing import Any, assert_never

from rosetta_jit.kernel import ir, nodes


def blocks_of(stmt: nodes.Stmt) -> tuple[nodes.Block, ...]:
    """The blocks inside a statement. A table is asked, as for all that every walk over kernels asks."""
    found = _BLOCKS.get(type(stmt))
    return () if found is None else found(stmt)


_BLOCKS: dict[type[nodes.Stmt], Callable[[Any], tuple[nodes.Block, ...]]] = {
    **dict.fromkeys((nodes.For, nodes.While), lambda stmt: (stmt.body,)),
    nodes.If: attrgetter("then", "otherwise"),
    nodes.Switch: lambda stmt: (*(block for _, block in stmt.cases), stmt.default),
}

NESTED = frozenset(_BLOCKS)
"""The kinds of statements that have blocks inside."""


def statements(block: nodes.Block) -> Iterator[tuple[nodes.Stmt, int]]:
    """Every statement of a block, of the blocks inside, and so on, each with its depth."""
    stack: list[Iterator[nodes.Stmt]] = [iter(block)]
    nested = _BLOCKS
    while stack:
        depth = len(stack)
        for stmt in stack[-1]:
            yield stmt, depth
            if type(stmt) in nested:
                stack.append(chain.from_iterable(nested[type(stmt)](stmt)))
                break
        else:
            stack.pop()


def flat(block: nodes.Block) -> list[nodes.Stmt]:
    """The same without depths, for who looks at all of them: in half the time."""
    found: list[nodes.Stmt] = []
    _append(block, found)
    return found


def _append(block: nodes.Block, found: list[nodes.Stmt]) -> None:
    for stmt in block:
        found.append(stmt)
        if type(stmt) in NESTED:
            for inner in blocks_of(stmt):
                _append(inner, found)


def expressions_of(stmt: nodes.Stmt) -> tuple[nodes.Expr, ...]:
    """The expressions that stand in a statement itself."""
    return _EXPRESSIONS[type(stmt)](stmt)


def _host_expressions(call: nodes.HostCall) -> tuple[nodes.Expr, ...]:
    spans = (part for extent in extents_of(call) for part in (_start(extent.address), extent.size))
    return (*call.arguments, *spans, call.failure.at, *call.failure.indices)


_EXPRESSIONS: dict[type[nodes.Stmt], Callable[[Any], tuple[nodes.Expr, ...]]] = {
    nodes.Require: lambda stmt: (stmt.at, stmt.size, stmt.failure.at, *stmt.failure.indices),
    nodes.Expect: lambda stmt: (stmt.condition, stmt.failure.at, *stmt.failure.indices),
    **dict.fromkeys((nodes.Let, nodes.Var, nodes.Assign, nodes.Switch), lambda stmt: (stmt.value,)),
    nodes.Store: attrgetter("at", "value"),
    nodes.SetField: attrgetter("place.row", "value"),
    **dict.fromkeys((nodes.Reserve, nodes.Advance, nodes.For), lambda stmt: (stmt.count,)),
    nodes.Copy: lambda stmt: (_start(stmt.target), _start(stmt.source), stmt.size),
    nodes.Fill: lambda stmt: (_start(stmt.target), stmt.size),
    nodes.While: lambda stmt: (stmt.condition, *stmt.invariant, stmt.measure),
    nodes.If: lambda stmt: (stmt.condition,),
    nodes.Return: lambda stmt: (stmt.position, *(value for _, value in stmt.registers)),
    nodes.Call: lambda stmt: (*stmt.arguments, *stmt.indices),
    nodes.HostCall: _host_expressions,
}


def operands(expr: nodes.Expr) -> tuple[nodes.Expr, ...]:
    """The expressions that stand in an expression itself."""
    found = _OPERANDS.get(type(expr))
    return () if found is None else found(expr)


_OPERANDS: dict[type[nodes.Expr], Callable[[Any], tuple[nodes.Expr, ...]]] = {
    **dict.fromkeys((nodes.Binary, nodes.Compare, nodes.Fits), attrgetter("left", "right")),
    **dict.fromkeys((nodes.Unary, nodes.Convert, nodes.Bits), lambda expr: (expr.operand,)),
    **dict.fromkeys((nodes.Digits, nodes.Scale), lambda expr: (expr.value,)),
    nodes.Load: lambda expr: (expr.at,),
    nodes.Get: lambda expr: (expr.place.row,),
    nodes.Select: attrgetter("condition", "then", "otherwise"),
    nodes.IsText: lambda expr: (_start(expr.address), expr.size),
    nodes.Nearest: lambda expr: (_start(expr.address), expr.size, expr.exponent),
    nodes.Lookup: lambda expr: (expr.index,),
}


def every_statement(kernel: ir.Kernel) -> list[nodes.Stmt]:
    """The statements of all bodies of a kernel."""
    return [stmt for body in kernel.bodies for stmt in flat(body)]


def extents_of(call: nodes.HostCall) -> tuple[nodes.Extent, ...]:
    """The bytes that a function of the host reads, and those that it fills."""
    return call.inputs if call.target is None else (*call.inputs, call.target)


def subexpressions(expr: nodes.Expr) -> list[nodes.Expr]:
    """An expression and all inside it."""
    return _with_parts([expr])


def parts_of(stmts: Iterable[nodes.Stmt]) -> list[nodes.Expr]:
    """All expressions of some statements, and all inside them."""
    return _with_parts([expr for stmt in stmts for expr in _EXPRESSIONS[type(stmt)](stmt)])


def _with_parts(parts: list[nodes.Expr]) -> list[nodes.Expr]:
    """Expressions and, behind them, all inside them."""
    inside = _OPERANDS
    for part in parts:  # which grows
        if type(part) in inside:
            parts += inside[type(part)](part)
    return parts


def bound_names(stmt: nodes.Stmt) -> tuple[str, ...]:
    """The names that a statement binds."""
    found = _BOUND.get(type(stmt))
    return () if found is None else found(stmt)


_BOUND: dict[type[nodes.Stmt], Callable[[Any], tuple[str, ...]]] = {
    **dict.fromkeys((nodes.Let, nodes.Var), lambda stmt: (stmt.name,)),
    nodes.For: lambda stmt: (stmt.variable,),
    nodes.Call: lambda stmt: tuple([result.name for result in stmt.results]),
    nodes.HostCall: lambda stmt: (stmt.result.name,),
}


def changed_names(body: nodes.Block) -> set[str]:
    """The variables that a loop assigns."""
    return {stmt.name for stmt in flat(body) if type(stmt) is nodes.Assign}


def _start(address: nodes.Address) -> nodes.Expr:
    match address:
        case nodes.Wire(at):
            return at
        case nodes.Place(_, row, _):
            return row
        case _:
            assert_never(address)
