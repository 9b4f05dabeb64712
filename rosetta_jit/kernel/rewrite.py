"""Rebuild expressions and statements with something in place of their parts. Nothing is changed in place.

What nothing changes in stays the object that it is: most of a kernel does so in most passes, and then is neither made nor compared again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from operator import is_
from types import MappingProxyType
from typing import assert_never

from rosetta_jit.kernel import ir
from rosetta_jit.kernel.walk import blocks_of, expressions_of, operands, parts_of, statements, subexpressions

NO_NAMES: Mapping[str, str] = MappingProxyType({})


def with_operands(expr: ir.Expr, change: Callable[[ir.Expr], ir.Expr]) -> ir.Expr:
    """An expression with each of its operands changed, in order."""
    old = operands(expr)
    if not old:
        return expr
    new = [change(operand) for operand in old]
    return expr if all(map(is_, new, old)) else _rebuilt(expr, new)


def _rebuilt(expr: ir.Expr, parts: list[ir.Expr]) -> ir.Expr:
    """An expression of the same kind with other operands."""
    remaining = iter(parts)

    def change(_: ir.Expr) -> ir.Expr:
        return next(remaining)

    match expr:
        case ir.Const() | ir.Local() | ir.Used() | ir.Capacity() | ir.HostValue() | ir.Register():
            return expr
        case ir.Load(type_, at, order):
            return ir.Load(type_, change(at), order)
        case ir.Get(type_, place):
            return ir.Get(type_, _place(place, change))
        case ir.Unary(function, operand):
            return ir.Unary(function, change(operand))
        case ir.Binary(op, left, right):
            return ir.Binary(op, change(left), change(right))
        case ir.Compare(op, left, right):
            return ir.Compare(op, change(left), change(right))
        case ir.Fits(op, left, right):
            return ir.Fits(op, change(left), change(right))
        case ir.Convert(type_, operand):
            return ir.Convert(type_, change(operand))
        case ir.Bits(type_, operand):
            return ir.Bits(type_, change(operand))
        case ir.Select(condition, then, otherwise):
            return ir.Select(change(condition), change(then), change(otherwise))
        case ir.IsText(address, size):
            return ir.IsText(_address(address, change), change(size))
        case ir.Nearest(address, size, exponent):
            return ir.Nearest(_address(address, change), change(size), change(exponent))
        case ir.Digits(value, places):
            return ir.Digits(change(value), places)
        case ir.Scale() | ir.Lookup():
            return ir.Scale(change(expr.value)) if isinstance(expr, ir.Scale) else ir.Lookup(expr.type, expr.values, change(expr.index))
        case _:
            assert_never(expr)


def with_expressions(stmt: ir.Stmt, change: Callable[[ir.Expr], ir.Expr]) -> ir.Stmt:
    """A statement with each expression that stands in it changed, in order; the blocks inside stay as they are."""
    old = expressions_of(stmt)
    new = [change(expr) for expr in old]
    return stmt if all(map(is_, new, old)) else _restated(stmt, new)


def _restated(stmt: ir.Stmt, parts: list[ir.Expr]) -> ir.Stmt:
    """A statement of the same kind with other expressions."""
    remaining = iter(parts)

    def change(_: ir.Expr) -> ir.Expr:
        return next(remaining)

    match stmt:
        case ir.Require(at, size, failure):
            return ir.Require(change(at), change(size), _failure(failure, change))
        case ir.Expect(condition, failure):
            return ir.Expect(change(condition), _failure(failure, change))
        case ir.Let() | ir.Var() | ir.Assign():
            return type(stmt)(stmt.name, change(stmt.value))
        case ir.Store() | ir.SetField() | ir.Copy() | ir.Fill():
            return _moved(stmt, change)
        case ir.Reserve() | ir.Advance():
            return type(stmt)(stmt.lane, change(stmt.count))
        case ir.For(variable, count, body):
            return ir.For(variable, change(count), body)
        case ir.While(condition, body, invariant, measure):
            return ir.While(change(condition), body, tuple(map(change, invariant)), change(measure))
        case ir.If(condition, then, otherwise):
            return ir.If(change(condition), then, otherwise)
        case ir.Switch(value, cases, default):
            return ir.Switch(change(value), cases, default)
        case ir.Return(position, registers):
            return ir.Return(change(position), tuple((number, change(value)) for number, value in registers))
        case ir.Call():
            return replace(stmt, arguments=tuple(map(change, stmt.arguments)), indices=tuple(map(change, stmt.indices)))
        case ir.HostCall():
            return _host_call(stmt, change)
        case _:
            assert_never(stmt)


def with_blocks(stmt: ir.Stmt, change: Callable[[ir.Block], ir.Block]) -> ir.Stmt:
    """A statement with each block inside it changed, in order."""
    old = blocks_of(stmt)
    if not old:
        return stmt
    new = [change(block) for block in old]
    return stmt if all(map(_is_same, new, old)) else _refilled(stmt, new)


def _is_same(block: ir.Block, other: ir.Block) -> bool:
    """Whether two blocks are made of the same objects."""
    return len(block) == len(other) and all(map(is_, block, other))


def _refilled(stmt: ir.Stmt, blocks: list[ir.Block]) -> ir.Stmt:
    """A statement of the same kind with other blocks."""
    match stmt:
        case ir.For() | ir.While():
            return replace(stmt, body=blocks[0])
        case ir.If(condition, _, _):
            return ir.If(condition, blocks[0], blocks[1])
        case ir.Switch(value, cases, _):
            return ir.Switch(value, tuple((number, block) for (number, _), block in zip(cases, blocks[:-1], strict=True)), blocks[-1])
        case _:
            return stmt


def with_bodies(kernel: ir.Kernel, bodies: tuple[ir.Block, ...]) -> ir.Kernel:
    """A kernel with other bodies; the same kernel if they are the same, and the same body where one is."""
    if bodies == kernel.bodies:
        return kernel
    return replace(kernel, bodies=tuple(old if new == old else new for old, new in zip(kernel.bodies, bodies, strict=True)))


def with_registers_behind(kernel: ir.Kernel, before: int, every: int) -> ir.Kernel:
    """A kernel whose registers lie behind so many others; ``every`` is how many there are in all."""
    if not kernel.registers or not before:
        return replace(kernel, registers=every)

    def moved(expr: ir.Expr) -> ir.Expr:
        return ir.Register(expr.number + before) if isinstance(expr, ir.Register) else with_operands(expr, moved)

    def restated(stmt: ir.Stmt) -> ir.Stmt:
        changed = with_blocks(with_expressions(stmt, moved), lambda block: tuple(map(restated, block)))
        if isinstance(changed, ir.Return):
            return replace(changed, registers=tuple((number + before, value) for number, value in changed.registers))
        return changed

    return replace(kernel, bodies=tuple(tuple(map(restated, body)) for body in kernel.bodies), registers=every)


def substituted(expr: ir.Expr, values: Mapping[str, ir.Expr], renamed: Mapping[str, str] = NO_NAMES) -> ir.Expr:
    """An expression with values in place of some locals, and other names for some."""
    if isinstance(expr, ir.Local):
        return values.get(expr.name) or (ir.Local(expr.type, renamed[expr.name]) if expr.name in renamed else expr)
    return with_operands(expr, lambda operand: substituted(operand, values, renamed))


def locals_in(expr: ir.Expr) -> set[str]:
    """Names of the locals that an expression reads."""
    return {part.name for part in subexpressions(expr) if isinstance(part, ir.Local)}


def names_in(stmts: Iterable[ir.Stmt]) -> set[str]:
    """Names of the locals that statements read themselves, not in the blocks inside."""
    return {part.name for part in parts_of(stmts) if isinstance(part, ir.Local)}


def names_read(block: ir.Block) -> set[str]:
    """Names of the locals that a block reads, at any depth."""
    return names_in(stmt for stmt, _ in statements(block))


def reads_memory(expr: ir.Expr) -> bool:
    """Whether an expression looks at the message or the holder."""
    return any(isinstance(part, ir.Load | ir.Get | ir.Used | ir.IsText | ir.Nearest) for part in subexpressions(expr))


def ends(block: ir.Block) -> bool:
    """Whether every path through a block returns."""
    match block[-1] if block else None:
        case ir.Return():
            return True
        case ir.If(_, then, otherwise):
            return ends(then) and ends(otherwise)
        case ir.Switch(_, cases, default):
            return ends(default) and all(ends(inner) for _, inner in cases)
        case _:
            return False


def may_return(block: ir.Block) -> bool:
    """Whether some path through a block returns."""
    return any(isinstance(stmt, ir.Return) for stmt, _ in statements(block))


def _moved(stmt: ir.Effect, change: Callable[[ir.Expr], ir.Expr]) -> ir.Effect:
    match stmt:
        case ir.Store(at, value, order):
            return ir.Store(change(at), change(value), order)
        case ir.SetField(place, value):
            return ir.SetField(_place(place, change), change(value))
        case ir.Copy(target, source, size):
            return ir.Copy(_address(target, change), _address(source, change), change(size))
        case ir.Fill(target, size, byte):
            return ir.Fill(_address(target, change), change(size), byte)
        case _:
            assert_never(stmt)


def _host_call(call: ir.HostCall, change: Callable[[ir.Expr], ir.Expr]) -> ir.HostCall:
    values = tuple(map(change, call.arguments))
    read = tuple(_extent(extent, change) for extent in call.inputs)
    written = None if call.target is None else _extent(call.target, change)
    return ir.HostCall(call.function, values, call.result, _failure(call.failure, change), read, written)


def _failure(failure: ir.Failure, change: Callable[[ir.Expr], ir.Expr]) -> ir.Failure:
    return ir.Failure(failure.site, change(failure.at), tuple(map(change, failure.indices)))


def _extent(extent: ir.Extent, change: Callable[[ir.Expr], ir.Expr]) -> ir.Extent:
    return ir.Extent(_address(extent.address, change), change(extent.size))


def _place(place: ir.Place, change: Callable[[ir.Expr], ir.Expr]) -> ir.Place:
    return ir.Place(place.lane, change(place.row), place.offset)


def _address(address: ir.Address, change: Callable[[ir.Expr], ir.Expr]) -> ir.Address:
    match address:
        case ir.Wire(at):
            return ir.Wire(change(at))
        case ir.Place():
            return _place(address, change)
        case _:
            assert_never(address)
