"""Rebuild expressions and statements with something in place of their parts. Nothing is changed in place.

What nothing changes in stays the object that it is: most of a kernel does so in most passes, and then is neither made nor compared again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from operator import is_
from types import MappingProxyType
from typing import assert_never

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.walk import NESTED, blocks_of, expressions_of, flat, operands, parts_of, statements, subexpressions
from rosetta_jit.startup.dataclass import replace

OF_MEMORY = frozenset((nodes.Load, nodes.Get, nodes.Used, nodes.IsText, nodes.Nearest))
"""The kinds of expressions that look at the message or the holder."""

NO_NAMES: Mapping[str, str] = MappingProxyType({})


def with_operands(expr: nodes.Expr, change: Callable[[nodes.Expr], nodes.Expr]) -> nodes.Expr:
    """An expression with each of its operands changed, in order."""
    old = operands(expr)
    if not old:
        return expr
    new = [change(operand) for operand in old]
    return expr if all(map(is_, new, old)) else _rebuilt(expr, new)


def _rebuilt(expr: nodes.Expr, parts: list[nodes.Expr]) -> nodes.Expr:
    """An expression of the same kind with other operands."""
    remaining = iter(parts)

    def change(_: nodes.Expr) -> nodes.Expr:
        return next(remaining)

    match expr:
        case nodes.Const() | nodes.Local() | nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return expr
        case nodes.Load(type_, at, order):
            return nodes.Load(type_, change(at), order)
        case nodes.Get(type_, place):
            return nodes.Get(type_, _place(place, change))
        case nodes.Unary(function, operand):
            return nodes.Unary(function, change(operand))
        case nodes.Binary(op, left, right):
            return nodes.Binary(op, change(left), change(right))
        case nodes.Compare(op, left, right):
            return nodes.Compare(op, change(left), change(right))
        case nodes.Fits(op, left, right):
            return nodes.Fits(op, change(left), change(right))
        case nodes.Convert(type_, operand) | nodes.Bits(type_, operand):
            return type(expr)(type_, change(operand))
        case nodes.Select(condition, then, otherwise):
            return nodes.Select(change(condition), change(then), change(otherwise))
        case nodes.IsText(address, size):
            return nodes.IsText(_address(address, change), change(size))
        case nodes.Nearest(address, size, exponent):
            return nodes.Nearest(_address(address, change), change(size), change(exponent))
        case nodes.Digits(value, places):
            return nodes.Digits(change(value), places)
        case nodes.Scale(value):
            return nodes.Scale(change(value))
        case nodes.Lookup(type_, values, index):
            return nodes.Lookup(type_, values, change(index))
        case _:
            assert_never(expr)


def with_expressions(stmt: nodes.Stmt, change: Callable[[nodes.Expr], nodes.Expr]) -> nodes.Stmt:
    """A statement with each expression that stands in it changed, in order; the blocks inside stay as they are."""
    old = expressions_of(stmt)
    new = [change(expr) for expr in old]
    return stmt if all(map(is_, new, old)) else _restated(stmt, new)


def _restated(stmt: nodes.Stmt, parts: list[nodes.Expr]) -> nodes.Stmt:
    """A statement of the same kind with other expressions."""
    remaining = iter(parts)

    def change(_: nodes.Expr) -> nodes.Expr:
        return next(remaining)

    match stmt:
        case nodes.Require(at, size, failure):
            return nodes.Require(change(at), change(size), _failure(failure, change))
        case nodes.Expect(condition, failure):
            return nodes.Expect(change(condition), _failure(failure, change))
        case nodes.Let() | nodes.Var() | nodes.Assign():
            return type(stmt)(stmt.name, change(stmt.value))
        case nodes.Store() | nodes.SetField() | nodes.Copy() | nodes.Fill():
            return _moved(stmt, change)
        case nodes.Reserve() | nodes.Advance():
            return type(stmt)(stmt.lane, change(stmt.count))
        case nodes.For(variable, count, body):
            return nodes.For(variable, change(count), body)
        case nodes.While(condition, body, invariant, measure):
            return nodes.While(change(condition), body, tuple(map(change, invariant)), change(measure))
        case nodes.If(condition, then, otherwise):
            return nodes.If(change(condition), then, otherwise)
        case nodes.Switch(value, cases, default):
            return nodes.Switch(change(value), cases, default)
        case nodes.Return(position, registers):
            return nodes.Return(change(position), tuple((number, change(value)) for number, value in registers))
        case nodes.Call():
            return replace(stmt, arguments=tuple(map(change, stmt.arguments)), indices=tuple(map(change, stmt.indices)))
        case nodes.HostCall():
            return _host_call(stmt, change)
        case _:
            assert_never(stmt)


def with_blocks(stmt: nodes.Stmt, change: Callable[[nodes.Block], nodes.Block]) -> nodes.Stmt:
    """A statement with each block inside it changed, in order."""
    if type(stmt) not in NESTED:
        return stmt
    old = blocks_of(stmt)
    new = [change(block) for block in old]
    return stmt if all(map(_is_same, new, old)) else _refilled(stmt, new)


def _is_same(block: nodes.Block, other: nodes.Block) -> bool:
    """Whether two blocks are made of the same objects."""
    return len(block) == len(other) and all(map(is_, block, other))


def _refilled(stmt: nodes.Stmt, blocks: list[nodes.Block]) -> nodes.Stmt:
    """A statement of the same kind with other blocks."""
    match stmt:
        case nodes.For() | nodes.While():
            return replace(stmt, body=blocks[0])
        case nodes.If(condition, _, _):
            return nodes.If(condition, blocks[0], blocks[1])
        case nodes.Switch(value, cases, _):
            return nodes.Switch(value, tuple((number, block) for (number, _), block in zip(cases, blocks[:-1], strict=True)), blocks[-1])
        case _:
            return stmt


def with_bodies(kernel: ir.Kernel, bodies: tuple[nodes.Block, ...]) -> ir.Kernel:
    """A kernel with other bodies; the same kernel if they are the same, and the same body where one is."""
    if bodies == kernel.bodies:
        return kernel
    return replace(kernel, bodies=tuple(old if new == old else new for old, new in zip(kernel.bodies, bodies, strict=True)))


def with_registers_behind(kernel: ir.Kernel, before: int, every: int) -> ir.Kernel:
    """A kernel whose registers lie behind so many others; ``every`` is how many there are in all."""
    if not kernel.registers or not before:
        return replace(kernel, registers=every)

    def moved(expr: nodes.Expr) -> nodes.Expr:
        return nodes.Register(expr.number + before) if isinstance(expr, nodes.Register) else with_operands(expr, moved)

    def restated(stmt: nodes.Stmt) -> nodes.Stmt:
        changed = with_blocks(with_expressions(stmt, moved), lambda block: tuple(map(restated, block)))
        if isinstance(changed, nodes.Return):
            return replace(changed, registers=tuple((number + before, value) for number, value in changed.registers))
        return changed

    return replace(kernel, bodies=tuple(tuple(map(restated, body)) for body in kernel.bodies), registers=every)


def substituted(expr: nodes.Expr, values: Mapping[str, nodes.Expr], renamed: Mapping[str, str] = NO_NAMES) -> nodes.Expr:
    """An expression with values in place of some locals, and other names for some."""
    if isinstance(expr, nodes.Local):
        return values.get(expr.name) or (nodes.Local(expr.type, renamed[expr.name]) if expr.name in renamed else expr)
    return with_operands(expr, lambda operand: substituted(operand, values, renamed))


def locals_in(expr: nodes.Expr) -> set[str]:
    """Names of the locals that an expression reads."""
    return {part.name for part in subexpressions(expr) if type(part) is nodes.Local}


def names_in(stmts: Iterable[nodes.Stmt]) -> set[str]:
    """Names of the locals that statements read themselves, not in the blocks inside."""
    return {part.name for part in parts_of(stmts) if type(part) is nodes.Local}


def names_read(block: nodes.Block) -> set[str]:
    """Names of the locals that a block reads, at any depth."""
    return names_in(flat(block))


def reads_memory(expr: nodes.Expr) -> bool:
    """Whether an expression looks at the message or the holder."""
    return any(type(part) in OF_MEMORY for part in subexpressions(expr))


def ends(block: nodes.Block) -> bool:
    """Whether every path through a block returns."""
    match block[-1] if block else None:
        case nodes.Return():
            return True
        case nodes.If(_, then, otherwise):
            return ends(then) and ends(otherwise)
        case nodes.Switch(_, cases, default):
            return ends(default) and all(ends(inner) for _, inner in cases)
        case _:
            return False


def may_return(block: nodes.Block) -> bool:
    """Whether some path through a block returns."""
    return any(isinstance(stmt, nodes.Return) for stmt, _ in statements(block))


def _moved(stmt: nodes.Effect, change: Callable[[nodes.Expr], nodes.Expr]) -> nodes.Effect:
    match stmt:
        case nodes.Store(at, value, order):
            return nodes.Store(change(at), change(value), order)
        case nodes.SetField(place, value):
            return nodes.SetField(_place(place, change), change(value))
        case nodes.Copy(target, source, size):
            return nodes.Copy(_address(target, change), _address(source, change), change(size))
        case nodes.Fill(target, size, byte):
            return nodes.Fill(_address(target, change), change(size), byte)
        case _:
            assert_never(stmt)


def _host_call(call: nodes.HostCall, change: Callable[[nodes.Expr], nodes.Expr]) -> nodes.HostCall:
    values = tuple(map(change, call.arguments))
    read = tuple(_extent(extent, change) for extent in call.inputs)
    written = None if call.target is None else _extent(call.target, change)
    return nodes.HostCall(call.function, values, call.result, _failure(call.failure, change), read, written)


def _failure(failure: nodes.Failure, change: Callable[[nodes.Expr], nodes.Expr]) -> nodes.Failure:
    return nodes.Failure(failure.site, change(failure.at), tuple(map(change, failure.indices)))


def _extent(extent: nodes.Extent, change: Callable[[nodes.Expr], nodes.Expr]) -> nodes.Extent:
    return nodes.Extent(_address(extent.address, change), change(extent.size))


def _place(place: nodes.Place, change: Callable[[nodes.Expr], nodes.Expr]) -> nodes.Place:
    return nodes.Place(place.lane, change(place.row), place.offset)


def _address(address: nodes.Address, change: Callable[[nodes.Expr], nodes.Expr]) -> nodes.Address:
    match address:
        case nodes.Wire(at):
            return nodes.Wire(change(at))
        case nodes.Place():
            return _place(address, change)
        case _:
            assert_never(address)
