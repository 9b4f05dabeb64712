"""What shows in a kernel's text without any proof: names bound once, nesting bounded, sites that exist."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel.ir import (
    BEGIN,
    END,
    ROW,
    Advance,
    Assign,
    Binary,
    Capacity,
    Compare,
    Const,
    Convert,
    Copy,
    Expect,
    Fill,
    Fits,
    For,
    Get,
    If,
    IsText,
    Let,
    Load,
    Local,
    Place,
    Require,
    Reserve,
    Return,
    Select,
    SetField,
    Store,
    Switch,
    Unary,
    Used,
    Var,
    While,
    Wire,
)
from rosetta_jit.kernel.state import MAX_INDICES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.kernel.ir import Address, Block, Expr, Kernel, Stmt

MAX_BLOCKS = 100
MAX_EXPRESSION = 100


def blocks_of(stmt: Stmt) -> tuple[Block, ...]:
    """The blocks inside a statement."""
    match stmt:
        case For(_, _, body) | While(_, body, _, _):
            return (body,)
        case If(_, then, otherwise):
            return (then, otherwise)
        case Switch(_, cases, default):
            return (*(block for _, block in cases), default)
        case _:
            return ()


def statements(block: Block) -> Iterator[tuple[Stmt, int]]:
    """Every statement of a block, of the blocks inside, and so on, each with its depth."""
    stack = [(stmt, 1) for stmt in reversed(block)]
    while stack:
        stmt, depth = stack.pop()
        yield stmt, depth
        inner = [(s, depth + 1) for part in blocks_of(stmt) for s in part]
        stack.extend(reversed(inner))


def expressions_of(stmt: Stmt) -> tuple[Expr, ...]:
    """The expressions that stand in a statement itself."""
    match stmt:
        case Require(at, size, failure):
            return (at, size, failure.at, *failure.indices)
        case Expect(condition, failure):
            return (condition, failure.at, *failure.indices)
        case Let(_, value) | Var(_, value) | Assign(_, value):
            return (value,)
        case Store(at, value, _):
            return (at, value)
        case SetField(place, value):
            return (place.row, value)
        case Reserve(_, count) | Advance(_, count) | For(_, count, _):
            return (count,)
        case Copy(target, source, size):
            return (_start(target), _start(source), size)
        case Fill(target, size, _):
            return (_start(target), size)
        case While(condition, _, invariant, measure):
            return (condition, *invariant, measure)
        case If(condition, _, _):
            return (condition,)
        case Switch(value, _, _):
            return (value,)
        case Return(position):
            return (position,)
        case _:
            assert_never(stmt)


def operands(expr: Expr) -> tuple[Expr, ...]:
    """The expressions that stand in an expression itself."""
    match expr:
        case Const() | Local() | Used() | Capacity():
            return ()
        case Load(_, at, _):
            return (at,)
        case Get(_, place):
            return (place.row,)
        case Unary(_, operand) | Convert(_, operand):
            return (operand,)
        case Binary(_, left, right) | Compare(_, left, right) | Fits(_, left, right):
            return (left, right)
        case Select(condition, then, otherwise):
            return (condition, then, otherwise)
        case IsText(address, size):
            return (_start(address), size)
        case _:
            assert_never(expr)


def subexpressions(expr: Expr) -> Iterator[tuple[Expr, int]]:
    """An expression and all inside it, each with its depth."""
    stack = [(expr, 1)]
    while stack:
        part, depth = stack.pop()
        yield part, depth
        stack.extend((operand, depth + 1) for operand in operands(part))


def bound_name(stmt: Stmt) -> str | None:
    """The name that a statement binds."""
    match stmt:
        case Let(name, _) | Var(name, _) | For(name, _, _):
            return name
        case _:
            return None


def shape_error(kernel: Kernel) -> str | None:
    """What is wrong with a kernel's text, if anything is."""
    bound = {BEGIN.name, END.name, ROW.name}
    if not kernel.bodies:
        return "a kernel without bodies"
    for stmt, depth in (pair for body in kernel.bodies for pair in statements(body)):
        name = bound_name(stmt)
        if name in bound:
            return f"{name} is bound twice"
        if name is not None:
            bound.add(name)
        problem = _statement_error(kernel, stmt, depth)
        if problem is not None:
            return problem
    return None


def _statement_error(kernel: Kernel, stmt: Stmt, depth: int) -> str | None:
    if depth > MAX_BLOCKS:
        return "blocks are nested too deep"
    if any(_too_deep(expr) for expr in expressions_of(stmt)):
        return "an expression is nested too deep"
    if isinstance(stmt, Require | Expect):
        if not 1 <= stmt.failure.site < len(kernel.sites):
            return f"no site {stmt.failure.site}"
        if len(stmt.failure.indices) > MAX_INDICES:
            return "too many indices"
    return None


def _too_deep(expr: Expr) -> bool:
    if isinstance(expr, Const | Local):
        return False
    return any(depth > MAX_EXPRESSION for _, depth in subexpressions(expr))


def _start(address: Address) -> Expr:
    match address:
        case Wire(at):
            return at
        case Place(_, row, _):
            return row
        case _:
            assert_never(address)
