"""Kernel statements as LLVM blocks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, assert_never

from llvmlite import ir

from rosetta_jit.backends.llvm import widths
from rosetta_jit.backends.llvm.alike import NOTHING, Part, Place, Series
from rosetta_jit.backends.llvm.expr import (
    copy_memory,
    expression,
    fill_memory,
    load,
    place_alignment,
    place_pointer,
    pointer,
    store,
    wire_pointer,
)
from rosetta_jit.backends.llvm.failing import check, cold, fail, require
from rosetta_jit.backends.llvm.frame import Frame, Variable
from rosetta_jit.backends.llvm.growth import reserve
from rosetta_jit.backends.llvm.values import COLD, I64, LLVM_TYPES, constant, forgotten
from rosetta_jit.kernel import ir as kernel
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.terms import BEGIN, END, type_of
from rosetta_jit.kernel.traits import looks_closer
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.backends.llvm import host, series, shared
    from rosetta_jit.backends.llvm import rounds as rounds_of_switch
else:
    host, series, shared, rounds_of_switch = late("rosetta_jit.backends.llvm", "host", "series", "shared", "rounds")

MANY_CASES = 64
GOLDEN = 0x9E3779B1
"""2**32 over the golden ratio: its multiples leave the numbers below 2**32 in an order without a pattern."""


def block(frame: Frame, statements: nodes.Block) -> None:
    """Print statements until one ends the block; what follows a Return is never reached."""
    for part in parts(frame, statements):
        print_part(frame, part)


def parts(frame: Frame, statements: nodes.Block) -> Sequence[Part]:
    """What a block is printed as."""
    return frame.alike.parts(statements)


def print_part(frame: Frame, part: Part) -> None:
    """Print a part of a block, unless one before it has ended it."""
    if frame.builder.block.is_terminated:
        return
    if isinstance(part, Series):
        series.print_series(frame, part, block)
    elif isinstance(part, Place):
        shared.print_place(frame, part, block)
    else:
        _statement(frame, part)


def _statement(frame: Frame, statement: nodes.Stmt) -> None:
    match statement:
        case nodes.Require(at, size, failure):
            require(frame, at, size, failure)
        case nodes.Expect(condition, failure):
            check(frame, expression(frame, condition), failure)
        case nodes.Let(name, value):
            frame.locals[name] = _value(frame, name, value)
        case nodes.Var(name, value):
            start = expression(frame, value)
            frame.builder.store(start, frame.variable(name, LLVM_TYPES[type_of(value)]).slot)
        case nodes.Assign(name, value):
            _assign(frame, name, value)
        case nodes.Store(at, value, order):
            store(frame, wire_pointer(frame, at), expression(frame, value), type_of(value), alignment=1, order=order)
        case nodes.SetField(place, value):
            alignment = place_alignment(frame, place, type_of(value))
            store(frame, place_pointer(frame, place), expression(frame, value), type_of(value), alignment=alignment)
        case nodes.Reserve(lane, count):
            reserve(frame, lane, expression(frame, count))
        case nodes.Advance(lane, count):
            slot = frame.used_slot(lane)
            rows = frame.builder.add(frame.builder.load(slot, typ=I64), expression(frame, count), flags=("nsw",))
            # One text behind another: what LLVM works out for a sum of sums takes exponential time.
            frame.builder.store(forgotten(frame.builder, rows) if frame.is_hidden(lane) else rows, slot)
        case nodes.Copy(target, source, size):
            copy_memory(frame, pointer(frame, target), pointer(frame, source), expression(frame, size))
        case nodes.Fill(target, size, byte):
            fill_memory(frame, pointer(frame, target), byte, expression(frame, size))
        case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
            _nested(frame, statement)
        case nodes.Return(position, registers):
            _keep(frame, registers)
            frame.done.enter(frame.builder, [expression(frame, position)])
        case nodes.Call():
            _call(frame, statement)
        case nodes.HostCall():
            _host_call(frame, statement)
        case _:
            assert_never(statement)


def _value(frame: Frame, name: str, value: nodes.Expr) -> ir.Value:
    """The value of a local: of a place in the message LLVM does not know how it was found.

    A place is a sum of the sizes of all that stands before it. What LLVM tries with the summands, for the addresses in each loop, takes
    time that grows with their third power. An index is no such sum: LLVM must see that what is computed from it grows by the same in each
    round, or a loop over elements does not become one over vectors.
    """
    number = expression(frame, value)
    if any(isinstance(frame.locals[each], ir.PhiInstr) or each in frame.indices for each in locals_in(value)):
        frame.indices.add(name)
        return number
    match value:
        case nodes.Binary("add", left, right) if (
            not isinstance(left, nodes.Const) and not isinstance(right, nodes.Const) and type_of(left) == "i64"
        ):
            return forgotten(frame.builder, number)
        case _:
            return number


def _keep(frame: Frame, registers: tuple[tuple[int, nodes.Expr], ...]) -> None:
    """Let registers hold other values from now on, all of which are computed from the old ones."""
    values = [expression(frame, value) for _, value in registers]
    for (number, _), value in zip(registers, values, strict=True):
        frame.builder.store(value, frame.register_word(frame.builder, number), align=8)


def _nested(frame: Frame, statement: nodes.For | nodes.While | nodes.If | nodes.Switch) -> None:
    match statement:
        case nodes.For():
            _for(frame, statement)
        case nodes.While():
            _while(frame, statement)
        case nodes.If():
            _if(frame, statement)
        case nodes.Switch():
            _switch(frame, statement)


def _call(frame: Frame, call: nodes.Call) -> None:
    routine = frame.routines[call.routine]
    if isinstance(routine, kernel.Routine):
        _inline(frame, call, routine)
        return
    builder, parameters = frame.builder, frame.parameters
    arguments = [expression(frame, each) for each in call.arguments]
    outcome = builder.call(routine, [parameters.buffer, parameters.begin, parameters.end, parameters.state, *arguments])
    if call.sites:
        number, first = builder.extract_value(outcome, 0), builder.extract_value(outcome, 1)
        good = cold(frame, builder.icmp_signed("==", number, constant(0)))
        fail(frame, call.sites, number, first, call.indices)
        builder.position_at_end(good)
    for position, result in enumerate(call.results, 1):
        frame.locals[result.name] = builder.extract_value(outcome, position)


def _inline(frame: Frame, call: nodes.Call, routine: kernel.Routine) -> None:
    """The routine's statements instead of a call."""
    names = {name: frame.locals[name] for name in (BEGIN.name, END.name)}
    arguments = {each.name: expression(frame, value) for each, value in zip(routine.parameters, call.arguments, strict=True)}
    inside = replace(frame, locals=names | arguments, caller=(frame, call), stretch=None, alike=NOTHING)
    block(inside, routine.body)
    for here, there in zip(call.results, routine.results, strict=True):
        frame.locals[here.name] = expression(inside, there)


def _host_call(frame: Frame, call: nodes.HostCall) -> None:
    status, result = host.host_called(frame, call)
    good = cold(frame, frame.builder.icmp_signed("==", status, ir.Constant(status.type, 0)))
    fail(frame, (call.failure.site,), constant(1), expression(frame, call.failure.at), call.failure.indices)
    frame.builder.position_at_end(good)
    frame.locals[call.result.name] = load(frame, result, call.result.type, alignment=1)


def _assign(frame: Frame, name: str, value: nodes.Expr) -> None:
    variable = frame.locals[name]
    if not isinstance(variable, Variable):
        raise AssertionError(f"{name} is no Var")  # noqa: TRY004 - our bug, not a caller's
    frame.builder.store(expression(frame, value), variable.slot)


def _for(frame: Frame, loop: nodes.For) -> None:
    count, streams = expression(frame, loop.count), widths.streams_of(loop, frame.strides)
    builder, first = frame.builder, constant(0)
    match streams if widths.are_known() else None:
        case "joined":
            whole = builder.and_(count, constant(-widths.ROUNDS))
            _rounds(frame, loop, _rounds(frame, loop, first, whole, is_wide=True), count)
        case "taken apart":
            whole, others, behind = frame.block("whole"), frame.block("others"), frame.block("after")
            left = builder.and_(count, constant(widths.ROUNDS - 1))
            builder.cbranch(builder.icmp_signed("==", left, constant(0)), whole, others)
            for chosen in (whole, others):
                builder.position_at_end(chosen)
                _rounds(frame, loop, first, count, is_wide=chosen is whole)
                builder.branch(behind)
            builder.position_at_end(behind)
        case None:
            _rounds(frame, loop, first, count)


def _rounds(frame: Frame, loop: nodes.For, first: ir.Value, end: ir.Value, *, is_wide: bool = False) -> ir.Value:
    """The rounds of a loop from one to the end, if there are any; gives the number of the one behind the last."""
    builder = frame.builder
    before, head, inside, behind = builder.block, frame.block("for"), frame.block("each"), frame.block("after")
    builder.branch(head)
    builder.position_at_end(head)
    index = builder.phi(I64, name=loop.variable)
    index.add_incoming(first, before)
    builder.cbranch(builder.icmp_signed("<", index, end), inside, behind)
    builder.position_at_end(inside)
    frame.locals[loop.variable] = index
    block(frame, loop.body)
    if not builder.block.is_terminated:
        index.add_incoming(builder.add(index, constant(1), flags=("nsw",)), builder.block)
        latch = builder.branch(head)
        if is_wide:
            widths.widen(builder.module, latch)
    builder.position_at_end(behind)
    return index


def _while(frame: Frame, loop: nodes.While) -> None:
    builder = frame.builder
    head, inside, behind = frame.block("while"), frame.block("round"), frame.block("after")
    builder.branch(head)
    builder.position_at_end(head)
    builder.cbranch(expression(frame, loop.condition), inside, behind)
    builder.position_at_end(inside)
    rounds = rounds_of_switch.rounds_of(loop)
    if rounds is None:
        _branch(frame, loop.body, head)
    else:
        end = frame.block("end")
        rounds_of_switch.print_switch(frame, rounds, end, behind, block)
        builder.position_at_end(end)
        _branch(frame, rounds.end, head)
    builder.position_at_end(behind)


def _if(frame: Frame, statement: nodes.If) -> None:
    builder, condition = frame.builder, expression(frame, statement.condition)
    yes, behind = frame.block("then"), frame.block("after")
    no = frame.block("else") if statement.otherwise else behind
    branch = builder.cbranch(condition, yes, no)
    if looks_closer(statement):
        branch.set_weights(COLD[::-1])
    builder.position_at_end(yes)
    _branch(frame, statement.then, behind)
    if statement.otherwise:
        builder.position_at_end(no)
        _branch(frame, statement.otherwise, behind)
    builder.position_at_end(behind)


def _switch(frame: Frame, statement: nodes.Switch) -> None:
    builder, value = frame.builder, expression(frame, statement.value)
    other, behind = frame.block("default"), frame.block("after")
    switch = builder.switch(value, other)
    alike = series.print_cases(frame, statement, switch, block, lambda _: builder.branch(behind)) if frame.alike.cases(statement) else ()
    for number, body in _shuffled(tuple(case for case in statement.cases if case[0] not in alike)):
        case = frame.block(f"case{number}")
        switch.add_case(ir.Constant(value.type, number), case)
        builder.position_at_end(case)
        _branch(frame, body, behind)
    builder.position_at_end(other)
    _branch(frame, statement.default, behind)
    builder.position_at_end(behind)


def _shuffled(cases: tuple[tuple[int, nodes.Block], ...]) -> list[tuple[int, nodes.Block]]:
    """The cases, if they are many in no order that means anything: so they will lie in memory.

    A processor foretells where a switch jumps to by the addresses that it jumped to before. Of a hundred cases of one size, taken in the
    order in which they lie, as the fields of a message come, these look all alike.
    """
    if len(cases) < MANY_CASES:
        return list(cases)
    return [case for _, case in sorted(enumerate(cases), key=lambda each: each[0] * GOLDEN % 2**32)]


def _branch(frame: Frame, body: nodes.Block, behind: ir.Block) -> None:
    block(frame, body)
    if not frame.builder.block.is_terminated:
        frame.builder.branch(behind)
