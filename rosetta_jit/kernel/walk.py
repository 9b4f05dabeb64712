"""The parts of statements and expressions of a kernel, for every walk over them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from operator import attrgetter
from typing import Any, assert_never

from rosetta_jit.kernel import ir


def blocks_of(stmt: ir.Stmt) -> tuple[ir.Block, ...]:
    """The blocks inside a statement. A table is asked, as for all that every walk over kernels asks."""
    found = _BLOCKS.get(type(stmt))
    return () if found is None else found(stmt)


_BLOCKS: dict[type[ir.Stmt], Callable[[Any], tuple[ir.Block, ...]]] = {
    **dict.fromkeys((ir.For, ir.While), lambda stmt: (stmt.body,)),
    ir.If: attrgetter("then", "otherwise"),
    ir.Switch: lambda stmt: (*(block for _, block in stmt.cases), stmt.default),
}


def statements(block: ir.Block) -> Iterator[tuple[ir.Stmt, int]]:
    """Every statement of a block, of the blocks inside, and so on, each with its depth."""
    stack: list[Iterator[ir.Stmt]] = [iter(block)]
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


def expressions_of(stmt: ir.Stmt) -> tuple[ir.Expr, ...]:
    """The expressions that stand in a statement itself."""
    return _EXPRESSIONS[type(stmt)](stmt)


def _host_expressions(call: ir.HostCall) -> tuple[ir.Expr, ...]:
    spans = (part for extent in extents_of(call) for part in (_start(extent.address), extent.size))
    return (*call.arguments, *spans, call.failure.at, *call.failure.indices)


_EXPRESSIONS: dict[type[ir.Stmt], Callable[[Any], tuple[ir.Expr, ...]]] = {
    ir.Require: lambda stmt: (stmt.at, stmt.size, stmt.failure.at, *stmt.failure.indices),
    ir.Expect: lambda stmt: (stmt.condition, stmt.failure.at, *stmt.failure.indices),
    **dict.fromkeys((ir.Let, ir.Var, ir.Assign, ir.Switch), lambda stmt: (stmt.value,)),
    ir.Store: attrgetter("at", "value"),
    ir.SetField: attrgetter("place.row", "value"),
    **dict.fromkeys((ir.Reserve, ir.Advance, ir.For), lambda stmt: (stmt.count,)),
    ir.Copy: lambda stmt: (_start(stmt.target), _start(stmt.source), stmt.size),
    ir.Fill: lambda stmt: (_start(stmt.target), stmt.size),
    ir.While: lambda stmt: (stmt.condition, *stmt.invariant, stmt.measure),
    ir.If: lambda stmt: (stmt.condition,),
    ir.Return: lambda stmt: (stmt.position, *(value for _, value in stmt.registers)),
    ir.Call: lambda stmt: (*stmt.arguments, *stmt.indices),
    ir.HostCall: _host_expressions,
}


def operands(expr: ir.Expr) -> tuple[ir.Expr, ...]:
    """The expressions that stand in an expression itself."""
    found = _OPERANDS.get(type(expr))
    return () if found is None else found(expr)


_OPERANDS: dict[type[ir.Expr], Callable[[Any], tuple[ir.Expr, ...]]] = {
    **dict.fromkeys((ir.Binary, ir.Compare, ir.Fits), attrgetter("left", "right")),
    **dict.fromkeys((ir.Unary, ir.Convert, ir.Bits), lambda expr: (expr.operand,)),
    **dict.fromkeys((ir.Digits, ir.Scale), lambda expr: (expr.value,)),
    ir.Load: lambda expr: (expr.at,),
    ir.Get: lambda expr: (expr.place.row,),
    ir.Select: attrgetter("condition", "then", "otherwise"),
    ir.IsText: lambda expr: (_start(expr.address), expr.size),
    ir.Nearest: lambda expr: (_start(expr.address), expr.size, expr.exponent),
    ir.Lookup: lambda expr: (expr.index,),
}


def every_statement(kernel: ir.Kernel) -> Iterator[ir.Stmt]:
    """The statements of all bodies of a kernel."""
    return (stmt for body in kernel.bodies for stmt, _ in statements(body))


def extents_of(call: ir.HostCall) -> tuple[ir.Extent, ...]:
    """The bytes that a function of the host reads, and those that it fills."""
    return call.inputs if call.target is None else (*call.inputs, call.target)


def subexpressions(expr: ir.Expr) -> list[ir.Expr]:
    """An expression and all inside it."""
    return _with_parts([expr])


def parts_of(stmts: Iterable[ir.Stmt]) -> list[ir.Expr]:
    """All expressions of some statements, and all inside them."""
    return _with_parts([expr for stmt in stmts for expr in _EXPRESSIONS[type(stmt)](stmt)])


def _with_parts(parts: list[ir.Expr]) -> list[ir.Expr]:
    """Expressions and, behind them, all inside them."""
    inside = _OPERANDS
    for part in parts:  # which grows
        if type(part) in inside:
            parts += inside[type(part)](part)
    return parts


def bound_names(stmt: ir.Stmt) -> tuple[str, ...]:
    """The names that a statement binds."""
    found = _BOUND.get(type(stmt))
    return () if found is None else found(stmt)


_BOUND: dict[type[ir.Stmt], Callable[[Any], tuple[str, ...]]] = {
    **dict.fromkeys((ir.Let, ir.Var), lambda stmt: (stmt.name,)),
    ir.For: lambda stmt: (stmt.variable,),
    ir.Call: lambda stmt: tuple([result.name for result in stmt.results]),
    ir.HostCall: lambda stmt: (stmt.result.name,),
}


def _start(address: ir.Address) -> ir.Expr:
    match address:
        case ir.Wire(at):
            return at
        case ir.Place(_, row, _):
            return row
        case _:
            assert_never(address)
