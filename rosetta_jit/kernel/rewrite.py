"""Rebuild expressions and statements with something in place of their parts. Nothing is changed in place.

What nothing changes in stays the object that it is: most of a kernel does so in most passes, and then is neither made nor compared again.
"""

from __future__ import annotations

from dataclasses import replace
from operator import is_
from types import MappingProxyType
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel.ir import (
    Advance,
    Assign,
    Binary,
    Bits,
    Call,
    Capacity,
    Compare,
    Const,
    Convert,
    Copy,
    Digits,
    Expect,
    Extent,
    Failure,
    Fill,
    Fits,
    For,
    Get,
    HostCall,
    HostValue,
    If,
    IsText,
    Let,
    Load,
    Local,
    Lookup,
    Nearest,
    Place,
    Register,
    Require,
    Reserve,
    Return,
    Scale,
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
from rosetta_jit.kernel.shape import blocks_of, expressions_of, operands, parts_of, statements, subexpressions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from rosetta_jit.kernel.ir import Address, Block, Effect, Expr, Kernel, Stmt

NO_NAMES: Mapping[str, str] = MappingProxyType({})


def with_operands(expr: Expr, change: Callable[[Expr], Expr]) -> Expr:
    """An expression with each of its operands changed, in order."""
    old = operands(expr)
    if not old:
        return expr
    new = [change(operand) for operand in old]
    return expr if all(map(is_, new, old)) else _rebuilt(expr, new)


def _rebuilt(expr: Expr, parts: list[Expr]) -> Expr:
    """An expression of the same kind with other operands."""
    given = iter(parts)

    def change(_: Expr) -> Expr:
        return next(given)

    match expr:
        case Const() | Local() | Used() | Capacity() | HostValue() | Register():
            return expr
        case Load(type_, at, order):
            return Load(type_, change(at), order)
        case Get(type_, place):
            return Get(type_, _place(place, change))
        case Unary(function, operand):
            return Unary(function, change(operand))
        case Binary(op, left, right):
            return Binary(op, change(left), change(right))
        case Compare(op, left, right):
            return Compare(op, change(left), change(right))
        case Fits(op, left, right):
            return Fits(op, change(left), change(right))
        case Convert(type_, operand):
            return Convert(type_, change(operand))
        case Bits(type_, operand):
            return Bits(type_, change(operand))
        case Select(condition, then, otherwise):
            return Select(change(condition), change(then), change(otherwise))
        case IsText(address, size):
            return IsText(_address(address, change), change(size))
        case Nearest(address, size, exponent):
            return Nearest(_address(address, change), change(size), change(exponent))
        case Digits(value, places):
            return Digits(change(value), places)
        case Scale() | Lookup():
            return Scale(change(expr.value)) if isinstance(expr, Scale) else Lookup(expr.type, expr.values, change(expr.index))
        case _:
            assert_never(expr)


def with_expressions(stmt: Stmt, change: Callable[[Expr], Expr]) -> Stmt:
    """A statement with each expression that stands in it changed, in order; the blocks inside stay as they are."""
    old = expressions_of(stmt)
    new = [change(expr) for expr in old]
    return stmt if all(map(is_, new, old)) else _restated(stmt, new)


def _restated(stmt: Stmt, parts: list[Expr]) -> Stmt:
    """A statement of the same kind with other expressions."""
    given = iter(parts)

    def change(_: Expr) -> Expr:
        return next(given)

    match stmt:
        case Require(at, size, failure):
            return Require(change(at), change(size), _failure(failure, change))
        case Expect(condition, failure):
            return Expect(change(condition), _failure(failure, change))
        case Let() | Var() | Assign():
            return type(stmt)(stmt.name, change(stmt.value))
        case Store() | SetField() | Copy() | Fill():
            return _moved(stmt, change)
        case Reserve() | Advance():
            return type(stmt)(stmt.lane, change(stmt.count))
        case For(variable, count, body):
            return For(variable, change(count), body)
        case While(condition, body, invariant, measure):
            return While(change(condition), body, tuple(map(change, invariant)), change(measure))
        case If(condition, then, otherwise):
            return If(change(condition), then, otherwise)
        case Switch(value, cases, default):
            return Switch(change(value), cases, default)
        case Return(position, registers):
            return Return(change(position), tuple((number, change(value)) for number, value in registers))
        case Call():
            return replace(stmt, arguments=tuple(map(change, stmt.arguments)), indices=tuple(map(change, stmt.indices)))
        case HostCall():
            return _asked(stmt, change)
        case _:
            assert_never(stmt)


def with_blocks(stmt: Stmt, change: Callable[[Block], Block]) -> Stmt:
    """A statement with each block inside it changed, in order."""
    old = blocks_of(stmt)
    if not old:
        return stmt
    new = [change(block) for block in old]
    return stmt if all(map(_is_same, new, old)) else _refilled(stmt, new)


def _is_same(block: Block, other: Block) -> bool:
    """Whether two blocks are made of the same objects."""
    return len(block) == len(other) and all(map(is_, block, other))


def _refilled(stmt: Stmt, blocks: list[Block]) -> Stmt:
    """A statement of the same kind with other blocks."""
    match stmt:
        case For() | While():
            return replace(stmt, body=blocks[0])
        case If(condition, _, _):
            return If(condition, blocks[0], blocks[1])
        case Switch(value, cases, _):
            return Switch(value, tuple((number, block) for (number, _), block in zip(cases, blocks[:-1], strict=True)), blocks[-1])
        case _:
            return stmt


def with_bodies(kernel: Kernel, bodies: tuple[Block, ...]) -> Kernel:
    """A kernel with other bodies; the same kernel if they are the same, and the same body where one is."""
    if bodies == kernel.bodies:
        return kernel
    return replace(kernel, bodies=tuple(old if new == old else new for old, new in zip(kernel.bodies, bodies, strict=True)))


def with_registers_behind(kernel: Kernel, before: int, every: int) -> Kernel:
    """A kernel whose registers lie behind so many others; ``every`` is how many there are in all."""
    if not kernel.registers or not before:
        return replace(kernel, registers=every)

    def moved(expr: Expr) -> Expr:
        return Register(expr.number + before) if isinstance(expr, Register) else with_operands(expr, moved)

    def restated(stmt: Stmt) -> Stmt:
        changed = with_blocks(with_expressions(stmt, moved), lambda block: tuple(map(restated, block)))
        if isinstance(changed, Return):
            return replace(changed, registers=tuple((number + before, value) for number, value in changed.registers))
        return changed

    return replace(kernel, bodies=tuple(tuple(map(restated, body)) for body in kernel.bodies), registers=every)


def substituted(expr: Expr, values: Mapping[str, Expr], renamed: Mapping[str, str] = NO_NAMES) -> Expr:
    """An expression with values in place of some locals, and other names for some."""
    if isinstance(expr, Local):
        return values.get(expr.name) or (Local(expr.type, renamed[expr.name]) if expr.name in renamed else expr)
    return with_operands(expr, lambda operand: substituted(operand, values, renamed))


def locals_in(expr: Expr) -> set[str]:
    """Names of the locals that an expression reads."""
    return {part.name for part in subexpressions(expr) if isinstance(part, Local)}


def names_in(stmts: Iterable[Stmt]) -> set[str]:
    """Names of the locals that statements read themselves, not in the blocks inside."""
    return {part.name for part in parts_of(stmts) if isinstance(part, Local)}


def names_read(block: Block) -> set[str]:
    """Names of the locals that a block reads, at any depth."""
    return names_in(stmt for stmt, _ in statements(block))


def reads_memory(expr: Expr) -> bool:
    """Whether an expression looks at the message or the holder."""
    return any(isinstance(part, Load | Get | Used | IsText | Nearest) for part in subexpressions(expr))


def ends(block: Block) -> bool:
    """Whether every path through a block returns."""
    match block[-1] if block else None:
        case Return():
            return True
        case If(_, then, otherwise):
            return ends(then) and ends(otherwise)
        case Switch(_, cases, default):
            return ends(default) and all(ends(inner) for _, inner in cases)
        case _:
            return False


def may_return(block: Block) -> bool:
    """Whether some path through a block returns."""
    return any(isinstance(stmt, Return) for stmt, _ in statements(block))


def _moved(stmt: Effect, change: Callable[[Expr], Expr]) -> Effect:
    match stmt:
        case Store(at, value, order):
            return Store(change(at), change(value), order)
        case SetField(place, value):
            return SetField(_place(place, change), change(value))
        case Copy(target, source, size):
            return Copy(_address(target, change), _address(source, change), change(size))
        case Fill(target, size, byte):
            return Fill(_address(target, change), change(size), byte)
        case _:
            assert_never(stmt)


def _asked(call: HostCall, change: Callable[[Expr], Expr]) -> HostCall:
    values = tuple(map(change, call.arguments))
    read = tuple(_extent(extent, change) for extent in call.inputs)
    written = None if call.target is None else _extent(call.target, change)
    return HostCall(call.function, values, call.result, _failure(call.failure, change), read, written)


def _failure(failure: Failure, change: Callable[[Expr], Expr]) -> Failure:
    return Failure(failure.site, change(failure.at), tuple(map(change, failure.indices)))


def _extent(extent: Extent, change: Callable[[Expr], Expr]) -> Extent:
    return Extent(_address(extent.address, change), change(extent.size))


def _place(place: Place, change: Callable[[Expr], Expr]) -> Place:
    return Place(place.lane, change(place.row), place.offset)


def _address(address: Address, change: Callable[[Expr], Expr]) -> Address:
    match address:
        case Wire(at):
            return Wire(change(at))
        case Place():
            return _place(address, change)
        case _:
            assert_never(address)
