"""Kernel statements as C statements, one a line.

What a message cannot be ends a function with a negative result: `fail` notes the site, the offset and the indices.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.generate.c.printing.calls import positions_found, print_call, print_host_call
from rosetta_jit.generate.c.printing.expressions import expression, list_within, location, store, written
from rosetta_jit.generate.c.printing.flag_loops import flags_done, flags_of
from rosetta_jit.generate.c.printing.function import Function, fail, fail_if, lacks
from rosetta_jit.generate.c.printing.room import rows_of
from rosetta_jit.generate.c.printing.straight import statement as straight_statement
from rosetta_jit.generate.c.printing.varint_loops import Sized, rounds_done, rounds_of
from rosetta_jit.generate.c.state import register_word
from rosetta_jit.generate.c.texts import comment
from rosetta_jit.generate.c.words import C_TYPES
from rosetta_jit.generate.origins import origin_of
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.aligned import aligned
from rosetta_jit.generate.passes.positions import (
    NONE,
    Positions,
    after_binding,
    after_call,
    after_require,
    bound_in,
    forget,
    joined,
    said_by,
)
from rosetta_jit.generate.passes.reachable import leaves
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.passes.fold import FALSE, folded
from rosetta_jit.kernel.terms import type_of

if TYPE_CHECKING:
    from rosetta_jit.generate.c.printing.scope import Scope


def print_block(function: Function, block: nodes.Block) -> Positions:
    """The statements of a block, and what is known of positions behind it; in the function it holds in there alone."""
    known, others = function.known, function.aligned
    function.aligned = aligned(block)
    for stmt in block:
        _statement(function, stmt)
    found, function.known, function.aligned = function.known, known, others
    return found


def _statement(function: Function, stmt: nodes.Stmt) -> None:
    scope = function.scope
    match stmt:
        case nodes.Require(at, size, failure):
            fail_if(function, lacks(function, at, size), failure)
            function.known = after_require(function.known, at, size)
        case nodes.Expect(condition, failure):
            if condition == FALSE:
                fail(function, failure)
            else:
                fail_if(function, expression(scope, folded(nodes.Unary("not", condition))), failure)
        case nodes.Let() | nodes.Var() | nodes.Assign():
            _bind(function, stmt)
            function.known = after_binding(function.known, stmt.name, stmt.value)
        case nodes.SetField(place, value) if (straight := straight_statement(scope, place, value)) is not None:
            for line in straight.splitlines():
                function.line(f"{line}{_origin(function, stmt)}")
        case nodes.Store() | nodes.SetField() | nodes.Copy() | nodes.Fill():
            function.line(f"{_effect(scope, stmt)}{_origin(function, stmt)}")
        case nodes.Reserve() | nodes.Advance():
            for line in rows_of(scope, stmt):
                function.line(line)
        case nodes.Return(position, registers):
            for line in function.finish:
                function.line(line)
            for number, value in registers:
                scope.takes("holder")
                function.line(f"{register_word(function.role, number)} = {bare(expression(scope, value))};")
            function.line(f"return {bare(expression(scope, position))};")
        case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
            _nested(function, stmt)
        case nodes.Call():
            print_call(function, stmt)
            function.known = after_call(function.known, stmt, positions_found(function, stmt))
        case nodes.HostCall():
            print_host_call(function, stmt)
            function.known = forget(function.known, bound_in(stmt))
        case _:
            assert_never(stmt)


def _bind(function: Function, stmt: nodes.Let | nodes.Var | nodes.Assign) -> None:
    """A local, if anything reads it; a state of a loop that begins where the message is goes on there."""
    stays = isinstance(stmt, nodes.Assign) and isinstance(stmt.value, nodes.Local) and stmt.value.name == stmt.name
    if stmt.name not in function.read or stays:
        return
    name, value = function.scope.locals.identifier(stmt.name), bare(expression(function.scope, function.aligned.get(stmt.name, stmt.value)))
    declared = "" if isinstance(stmt, nodes.Assign) else f"{C_TYPES[type_of(stmt.value)]} "
    function.line(f"{'const ' if isinstance(stmt, nodes.Let) else ''}{declared}{name} = {value};{_origin(function, stmt)}")


def _origin(function: Function, stmt: nodes.Stmt) -> str:
    """The line of the mapping that a statement comes from, as a comment behind it."""
    line = origin_of(stmt, function.origins) if function.origins else None
    return "" if line is None else f" {comment(line)}"


def _effect(scope: Scope, stmt: nodes.Effect) -> str:
    match stmt:
        case nodes.Store(at, value, order):
            return store(scope, at, value, order)
        case nodes.SetField(place, value):
            return written(scope, place, value)
        case nodes.Copy(target, source, size):
            return _copy(scope, target, source, size)
        case nodes.Fill(target, size, byte):
            return _fill(scope, target, size, byte)
        case _:
            assert_never(stmt)


def _copy(scope: Scope, target: nodes.Address, source: nodes.Address, count: nodes.Expr) -> str:
    size = bare(expression(scope, count))
    if isinstance(source, nodes.Place) and (view := _shown(scope, source)) is not None:
        taken = (*location(scope, target), *view, str(source.offset), size)
        return f"rosetta_jit::detail::copy_rows({', '.join(taken)});"
    if scope.lanes.dialect == "c++" and isinstance(count, nodes.Const):
        return f"rosetta_jit::detail::copy_known<{size}>({', '.join((*location(scope, target), *location(scope, source)))});"
    copied = ", ".join((*location(scope, target), *location(scope, source), size))
    lanes = [each.lane for each in (target, source) if isinstance(each, nodes.Place)]
    if scope.lanes.dialect == "c++" and any(scope.lanes.stride(lane) > 1 or lane in scope.lanes.opened for lane in lanes):
        return f"rosetta_jit::detail::copy_numbers({copied});"
    if scope.lanes.dialect == "c++" and isinstance(source, nodes.Place):
        return f"rosetta_jit::detail::copy_few({copied});"
    return f"{scope.calls('copy_bytes')}({copied});"


def _shown(scope: Scope, source: nodes.Place) -> tuple[str, str] | None:
    """What shows a list of an object, and the number of an element, if rows are made of these."""
    if source.lane in scope.lanes.within:
        return list_within(scope, source.lane, source.row)
    return (scope.rows(source.lane), bare(expression(scope, source.row))) if source.lane in scope.lanes.viewed else None


def _fill(scope: Scope, target: nodes.Address, size: nodes.Expr, byte: int) -> str:
    memory, start = location(scope, target)
    is_known = isinstance(size, nodes.Const) and size.value > 0
    if scope.lanes.dialect == "c++" and is_known:
        return f"rosetta_jit::detail::fill_known<{expression(scope, size)}>({memory}, {start}, {byte});"
    if isinstance(target, nodes.Place) and is_known and start == "0":
        return f"memset({memory}, {byte}, {expression(scope, size)});"
    if scope.lanes.dialect == "c++":
        return f"rosetta_jit::detail::fill_few({memory}, {start}, {bare(expression(scope, size))}, {byte});"
    return f"{scope.calls('fill_bytes')}({memory}, {start}, {bare(expression(scope, size))}, {byte});"


def _nested(function: Function, stmt: nodes.For | nodes.While | nodes.If | nodes.Switch) -> None:
    """A statement with blocks, and what is known of positions behind it."""
    match stmt:
        case nodes.For() | nodes.While():
            function.known = forget(function.known, bound_in(stmt))
            function.known |= said_by(stmt.invariant) if isinstance(stmt, nodes.While) else NONE
            _loop(function, stmt)
        case nodes.If(condition, then, otherwise):
            function.known = joined(stmt, _if(function, condition, then, otherwise))
        case nodes.Switch(value, cases, default):
            with function.block(f"switch ({bare(expression(function.scope, value))})"):
                ends = [
                    each
                    for number, body in cases
                    for each in _case(function, f"case {expression(function.scope, nodes.Const(type_of(value), number))}:", body)
                ]
                ends += _case(function, "default:", default)
            function.known = joined(stmt, ends)
        case _:
            assert_never(stmt)


def _loop(function: Function, stmt: nodes.For | nodes.While) -> None:
    """A loop: within it, what it changes is not known but for what it says."""
    scope = function.scope
    match stmt:
        case nodes.For(variable, count, body):
            name, bound = scope.locals.identifier(variable), bare(expression(scope, count))
            if not isinstance(count, nodes.Const | nodes.Local):
                function.line(f"const int64_t {(before := scope.locals.identifier(f'{variable} count'))} = {bound};")
                bound = before
            flags = flags_of(stmt)
            done = None if flags is None else flags_done(scope, flags, bound)
            if flags is not None and done is not None and not flags.is_read:
                function.line(f"{done};")
                return
            begin = f"int64_t {name} = {done or 0}"
            with _unless_copied(function, stmt, bound), function.block(f"for ({begin}; {name} < {bound}; {name}++)"):
                print_block(function, body)
        case nodes.While(condition, body):
            rounds = rounds_of(stmt) if scope.lanes.dialect == "c++" else None
            for line in rounds_done(scope, rounds) if rounds is not None else ():
                function.line(line)
            if isinstance(rounds, Sized):
                return
            with function.block(f"while ({bare(expression(scope, condition))})"):
                print_block(function, body)
        case _:
            assert_never(stmt)


@contextmanager
def _unless_copied(function: Function, stmt: nodes.For, count: str) -> Generator[None]:
    """Around a loop that sets a list: where its elements lie in the object as in the message, all are copied at once instead."""
    scope, packed = function.scope, function.scope.lanes.packed.get(stmt)
    if packed is None:
        yield
        return
    scope.moved.add(packed.lane)
    with function.block(f"if ({packed.lies})"):
        what = (scope.rows(packed.lane), f"{scope.takes('bytes')} + {expression(scope, packed.at)}", f"{count} * {packed.size}")
        function.line(f"{packed.copy}({', '.join(what)});")
    function.writer.lines[-1] += " else {"
    function.writer.depth += 1
    yield
    function.writer.depth -= 1
    function.line("}")


def _if(function: Function, condition: nodes.Expr, then: nodes.Block, otherwise: nodes.Block) -> list[Positions]:
    """What is known at the ends of the branches that have one."""
    if not then:
        condition, then, otherwise = folded(nodes.Unary("not", condition)), otherwise, ()
    with function.block(f"if ({bare(expression(function.scope, condition))})"):
        ends = _branch(function, then)
    if not otherwise:
        return [*ends, function.known]
    function.writer.lines[-1] += " else {"
    function.writer.depth += 1
    ends += _branch(function, otherwise)
    function.writer.depth -= 1
    function.line("}")
    return ends


def _branch(function: Function, block: nodes.Block) -> list[Positions]:
    known = print_block(function, block)
    return [] if leaves(block) else [known]


def _case(function: Function, label: str, body: nodes.Block) -> list[Positions]:
    function.writer.depth -= 1
    with function.block(label):
        ends = _branch(function, body)
        if ends:
            function.line("break;")
    function.writer.depth += 1
    return ends
