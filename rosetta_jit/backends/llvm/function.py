"""A kernel as one LLVM function, printed through llvmlite.ir.

    int64 kernel(uint8 *buffer, int64 begin, int64 end, int64 *state, int64 row)

Statements and expressions have printers of their own (`llvm_stmt`, `llvm_expr`). Here stands what frames them: parameters, the attempts one
after another, and what a failure and a success write to the holder's state.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from llvmlite import ir

from rosetta_jit.backends.llvm import checks as llvm_checks
from rosetta_jit.backends.llvm import definitions
from rosetta_jit.backends.llvm.alike import NOTHING, Found, may_have_series, may_share
from rosetta_jit.backends.llvm.exits import Exit, StoredExit
from rosetta_jit.backends.llvm.frame import Frame, Parameters, leave_copies, new_function
from rosetta_jit.backends.llvm.lines import Lines
from rosetta_jit.backends.llvm.routines import Printed, routines_of
from rosetta_jit.backends.llvm.usual import without_row
from rosetta_jit.backends.llvm.values import COLD, I64, POINTER, constant, state_word
from rosetta_jit.backends.printing import counted_lanes, emptied_lanes, statements
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Call, Expect, Expr, HostCall, Require, Stmt
from rosetta_jit.kernel.state import (
    CAPACITY,
    ERROR_INDICES,
    ERROR_OFFSET,
    ERROR_SITE,
    GROW,
    GROW_LANE,
    GROW_ROWS,
    HIDDEN_COUNT,
    INDEX_WORDS,
    UNUSUAL,
    USED,
    lane_word,
)
from rosetta_jit.kernel.traits import are_straight_and_compute, has_loops_for_vectors, is_straight
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.backends.llvm import series, stretches, twins
else:
    series, stretches, twins = late("rosetta_jit.backends.llvm", "series", "stretches", "twins")

SIGNATURE = ir.FunctionType(I64, [POINTER, I64, I64, POINTER, I64])
ARGUMENTS = ("buffer", "begin", "end", "state", "row")

MANY_STATEMENTS = 512
"""Statements of a body from which on its failures are so many that each stores what it reports."""


def emit(module: ir.Module, kernel: Kernel, name: str, *, whole: bool = True, has_usual: bool = False) -> ir.Function:
    """Define the kernel's function in the module.

    The kernel must have passed `verify`: what it promises there is handed to LLVM as a fact.

    Parameters
    ----------
    whole
        Whether common routines and the functions of `support` that the kernel calls are defined, too, or only declared. The next kernel of
        one that goes on is declared in any case.
    has_usual
        Whether the first body of several is a function for others, too, to be put into what calls it: `NAME.usual`, which gives `UNUSUAL`
        where `NAME.next` is to be asked. Who calls it knows that the holder has the row.
    """
    routines = routines_of(module, kernel, name, whole=whole)
    inside = f"{name}.inside" if kernel.hidden else name
    usual = new_function(module, SIGNATURE, f"{name}.usual", ARGUMENTS) if has_usual and len(kernel.bodies) > 1 else None
    function = new_function(module, SIGNATURE, inside, ARGUMENTS)
    if has_loops_for_vectors(kernel):
        leave_copies(function)
    following = _following(module, kernel, 1, f"{inside}.next", routines)
    if following is not None and usual is not None:
        following.linkage = following.calling_convention = ""  # others call it, which keep little
    if usual is None or following is None:
        _attempt(function, kernel, 0, routines, following)
    else:
        usual.attributes.add("alwaysinline")
        known, row = without_row(kernel)
        _attempt(usual, known, 0, routines, constant(UNUSUAL))
        _usual_or_next(function, kernel, row, usual, following)
    if whole:
        definitions.define(module)
    return _behind_check(module, kernel, function, name) if kernel.hidden else function


def _usual_or_next(function: ir.Function, kernel: Kernel, row: Expect | None, usual: ir.Function, following: ir.Function) -> None:
    """The body of a kernel's function whose bodies have functions of their own, and the check that the usual one leaves out."""
    builder = ir.IRBuilder(function.append_basic_block("entry"))
    first, done, other = (function.append_basic_block(name) for name in ("first", "done", "other"))
    if row is None:
        builder.branch(first)
    else:
        _, begin, _, state, number = function.args
        missing = function.append_basic_block("missing")
        rows = builder.load(state_word(builder, state, lane_word(0, CAPACITY)), typ=I64, align=8)
        builder.cbranch(builder.icmp_signed("<", number, rows), first, missing).set_weights(COLD)
        builder.position_at_end(missing)
        told = (constant(row.failure.site), begin, *[constant(0)] * _width(kernel))
        for word, value in zip(_words(len(told)), told, strict=True):
            builder.store(value, state_word(builder, state, word), align=8)
        builder.branch(other)
    builder.position_at_end(first)
    result = builder.call(usual, function.args)
    builder.cbranch(builder.icmp_signed("!=", result, constant(UNUSUAL)), done, other).set_weights(COLD)
    builder.position_at_end(done)
    builder.ret(result)
    builder.position_at_end(other)
    builder.ret(builder.call(following, function.args))


def _behind_check(module: ir.Module, kernel: Kernel, inside: ir.Function, name: str) -> ir.Function:
    """The function that makes sure of the hidden lanes first: where there are too few, GROW for the last one."""
    inside.linkage = "internal"
    inside.attributes.add("alwaysinline")
    function = new_function(module, SIGNATURE, name, ARGUMENTS)
    builder = ir.IRBuilder(function.append_basic_block("entry"))
    state = function.args[3]
    count = builder.load(state_word(builder, state, HIDDEN_COUNT), typ=I64, align=8)
    enough, few = function.append_basic_block("enough"), function.append_basic_block("few")
    builder.cbranch(builder.icmp_signed(">=", count, constant(kernel.hidden)), enough, few).set_weights(COLD)
    builder.position_at_end(few)
    builder.store(constant(len(kernel.strides) - 1), state_word(builder, state, GROW_LANE), align=8)
    builder.store(constant(0), state_word(builder, state, GROW_ROWS), align=8)
    builder.ret(constant(GROW))
    builder.position_at_end(enough)
    builder.ret(builder.call(inside, function.args))
    return function


def _attempt(
    function: ir.Function,
    kernel: Kernel,
    number: int,
    routines: Printed,
    otherwise: ir.Function | ir.Constant | None,
) -> None:
    """One of the bodies. What has failed so far stands in the state.

    Parameters
    ----------
    otherwise
        Where failures lead to: a function of the same arguments, or a result; None for the failure's own.
    """
    entry, first = Lines(function.append_basic_block("entry")), function.append_basic_block("body")
    body, is_first = kernel.bodies[number], number == 0
    alike = _series_of(kernel, body, is_first=is_first)
    stores = is_first and (alike.has_places or len(statements(body)) >= MANY_STATEMENTS)
    done, failed = Exit.new(entry, "done", 1), _failed(entry, kernel, function.args[3], stores=stores)
    parameters, lanes, emptied = Parameters(*function.args), (kernel.strides, kernel.lanes), emptied_lanes(kernel)
    frame = Frame(function.module, entry, entry.beside(first), parameters, *lanes, {}, done, failed, emptied, routines)
    frame.locals.update(begin=parameters.begin, end=parameters.end, row=parameters.row)
    counted = counted_lanes(kernel, body)
    frame.alike, frame.counting = alike, bool(counted)
    if alike and counted:
        series.begin_rows(frame, kernel.direction)
    llvm_checks.body(frame, body, in_vectors=is_first and are_straight_and_compute((kernel,)))
    if not frame.builder.block.is_terminated:
        frame.builder.unreachable()  # verified: every path that gets here has ended in a Return before
    _finish(frame, counted)
    entry.branch(first)
    if failed.is_reached:
        _end_failed(frame, otherwise, is_first=is_first)
    else:
        failed.drop()


def _end_failed(frame: Frame, otherwise: ir.Function | ir.Constant | None, *, is_first: bool) -> None:
    """Record the failures of a body, and lead to what `_attempt` is told."""
    builder = ir.IRBuilder(frame.failed.block)
    site = _record(builder, frame.parameters.state, frame.failed, is_first=is_first)
    match otherwise:
        case None:
            builder.ret(builder.sub(constant(-1), site))
        case ir.Function():
            builder.ret(builder.call(otherwise, frame.entry.function.args))
        case _:
            builder.ret(otherwise)


def _series_of(kernel: Kernel, body: Block, *, is_first: bool) -> Found:
    """What repeats itself in a body: most are too short for that to be looked for."""
    found = stretches.found(kernel, body) if may_have_series(kernel, body) else NOTHING
    return twins.with_places(found, kernel, body) if is_first and may_share(kernel, body) else found


def _following(module: ir.Module, kernel: Kernel, number: int, name: str, routines: Printed) -> ir.Function | None:
    """The function of the bodies from one on, or of the next kernel, which others define; None behind the last one.

    Each body has a function of its own, so that those behind the first take no part in what it keeps in registers. Of those without loops,
    which cannot cost much, LLVM makes code in half of the time, that takes some 15 % longer.
    """
    if number == len(kernel.bodies):
        return _of_next(module, name) if kernel.goes_on else None
    function = _of_next(module, name)
    function.linkage = "internal"
    if is_straight(kernel.bodies[number]):
        function.attributes.add("optnone")
    _attempt(function, kernel, number, routines, _following(module, kernel, number + 1, f"{name}.next", routines))
    return function


def _of_next(module: ir.Module, name: str) -> ir.Function:
    """A function that goes on where another one failed. It saves the registers that it uses, so that those that call it need not."""
    function = new_function(module, SIGNATURE, name, ARGUMENTS)
    function.attributes.add("noinline")
    function.calling_convention = "preserve_mostcc"
    return function


def _width(kernel: Kernel) -> int:
    """The indices that the kernel's failures report."""
    return min(INDEX_WORDS, max((_index_count(body) for body in kernel.bodies), default=0))


def _failed(entry: ir.IRBuilder, kernel: Kernel, state: ir.Value, *, stores: bool) -> Exit | StoredExit:
    """Where the failures of a body lead to, each of which ``stores`` what it reports or brings it there."""
    if stores:
        numbers = _words(2 + _width(kernel))
        words = tuple(state_word(entry, state, each) for each in numbers)
        return StoredExit(entry.function.append_basic_block("failed"), words, numbers)
    return Exit.new(entry, "failed", 2 + _width(kernel))


def _words(count: int) -> tuple[int, ...]:
    """Where the state has the site, the offset and the indices of a failure."""
    return ERROR_SITE, ERROR_OFFSET, *range(ERROR_INDICES, ERROR_INDICES + count - 2)


def _finish(frame: Frame, lanes: Sequence[int]) -> None:
    """Success: only now do used lengths count."""
    if not frame.done.is_reached:
        frame.done.drop()
        return
    builder = ir.IRBuilder(frame.done.block)
    if frame.rows is not None:
        series.end_rows(frame, lanes)
        return
    for lane in lanes:
        word = state_word(builder, frame.parameters.state, lane_word(lane, USED))
        builder.store(frame.used_in_the_end(builder, lane), word, align=8)
    builder.ret(frame.done.phis[0])


def _record(builder: ir.IRBuilder, state: ir.Value, failed: Exit | StoredExit, *, is_first: bool) -> ir.Value:
    """The failure of the attempt that got farther, in the state: site, offset, indices; the earlier one of equals. Gives its site."""
    if isinstance(failed, StoredExit):
        return builder.load(state_word(builder, state, ERROR_SITE), typ=I64, align=8)
    failure: Sequence[ir.Value] = failed.phis
    words = [state_word(builder, state, each) for each in _words(len(failure))]
    if not is_first:
        earlier = [builder.load(word, typ=I64, align=8) for word in words]
        farther = builder.icmp_signed(">", failure[1], earlier[1])
        failure = [builder.select(farther, new, old) for new, old in zip(failure, earlier, strict=True)]
    for word, value in zip(words, failure, strict=True):
        builder.store(value, word, align=8)
    return failure[0]


def _index_count(body: Block) -> int:
    """The most indices that a failure of the body reports."""
    return max([len(_indices(each)) for each in statements(body)], default=0)


def _indices(statement: Stmt) -> Sequence[Expr]:
    match statement:
        case Require(_, _, failure) | Expect(_, failure) | HostCall(_, _, _, failure):
            return failure.indices
        case Call():
            return statement.indices
        case _:
            return ()
