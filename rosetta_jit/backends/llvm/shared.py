"""Blocks that several places share, as LLVM functions: each place calls one with its row of a table.

    {status, variable…} NAME(buffer, begin, end, state, row, rows, numbers, hidden…, name…, variable…)

The status is 0, `GROW`, or that of a failure, which has stored what it reports. Variables around the block that it assigns come as values,
and go back so: in memory LLVM could not keep them in registers.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from llvmlite import ir

from rosetta_jit.backends.llvm.alike import Number, Place, Shared
from rosetta_jit.backends.llvm.exits import Exit, StoredExit
from rosetta_jit.backends.llvm.expr import expression
from rosetta_jit.backends.llvm.failing import cold
from rosetta_jit.backends.llvm.frame import Frame, Parameters, Stretch, Variable, new_function
from rosetta_jit.backends.llvm.growth import grow
from rosetta_jit.backends.llvm.lines import Lines
from rosetta_jit.backends.llvm.series import columns_of, words_of
from rosetta_jit.backends.llvm.tables import table
from rosetta_jit.backends.llvm.values import I64, LLVM_TYPES, POINTER, constant, state_word
from rosetta_jit.kernel.nodes import Block, Local
from rosetta_jit.kernel.state import GROW

if TYPE_CHECKING:
    Printer = Callable[[Frame, Block], None]

FAILED = 1
PARAMETERS = ("buffer", "begin", "end", "state", "row", "rows", "numbers")


def print_place(frame: Frame, place: Place, block: Printer) -> None:
    """A call of the function, and what follows from its status."""
    builder, shared, failed = frame.builder, place.shared, frame.failed
    assert isinstance(failed, StoredExit)
    if id(shared) not in frame.functions:
        frame.functions[id(shared)] = _define(frame, place, block)
    function, parameters = frame.functions[id(shared)], frame.parameters
    variables = [_variable(frame, place.names[name]) for name in shared.assigns]
    numbers = [each for row in shared.series.rows for each in row]
    row = state_word(builder, table(frame.module, numbers), place.row * len(shared.series.rows[0])) if numbers else parameters.state
    around = [expression(frame, Local(each.type, place.names[each.name])) for each in shared.reads]
    outcome = builder.call(
        function,
        [
            *(parameters.buffer, parameters.begin, parameters.end, parameters.state, parameters.row),
            *(frame.rows or parameters.state, row),
            *map(frame.used_slot, shared.hidden),
            *around,
            *(builder.load(each.slot, typ=each.type) for each in variables),
        ],
    )
    status = builder.extract_value(outcome, 0)
    good = cold(frame, builder.icmp_signed("==", status, constant(0)))
    builder.cbranch(builder.icmp_signed("==", status, constant(GROW)), grow(frame), failed.block)
    failed.is_reached = True
    builder.position_at_end(good)
    for number, each in enumerate(variables, 1):
        builder.store(builder.extract_value(outcome, number), each.slot)


def _variable(frame: Frame, name: str) -> Variable:
    variable = frame.locals[name]
    assert isinstance(variable, Variable)
    return variable


def _define(frame: Frame, place: Place, block: Printer) -> ir.Function:
    """The function of a block, where the first place calls it."""
    shared = place.shared
    types = {name: _variable(frame, place.names[name]).type for name in shared.assigns}
    names = [each.name for each in shared.reads]
    hidden = [f"hidden{lane}" for lane in shared.hidden]
    outcome = ir.LiteralStructType([I64, *types.values()])
    kinds = [*[POINTER] * len(hidden), *(LLVM_TYPES[each.type] for each in shared.reads), *types.values()]
    signature = ir.FunctionType(outcome, [POINTER, I64, I64, POINTER, I64, POINTER, POINTER, *kinds])
    name = f"{frame.entry.function.name}.shared{len(frame.functions)}"
    function = new_function(frame.module, signature, name, (*PARAMETERS, *hidden, *names, *shared.assigns))
    function.linkage = "internal"
    function.attributes.add("noinline")
    inside, first = _inside(frame, shared, function, outcome)
    for name, value in zip(names, function.args[len(PARAMETERS) + len(hidden) :], strict=False):
        inside.locals[name] = value
    for (name, type_), value in zip(types.items(), function.args[len(function.args) - len(types) :], strict=True):
        inside.entry.store(value, inside.variable(name, type_).slot)
    block(inside, shared.series.body)
    builder = inside.builder
    if not builder.block.is_terminated:
        inside.leave(constant(0), [builder.load(_variable(inside, name).slot, typ=type_) for name, type_ in types.items()])
    inside.entry.branch(first)
    builder.position_at_end(inside.failed.block)
    if inside.failed.is_reached:
        inside.leave(constant(FAILED))
    else:
        builder.unreachable()
    return function


def _inside(frame: Frame, shared: Shared, function: ir.Function, outcome: ir.LiteralStructType) -> tuple[Frame, ir.Block]:
    """The frame of the function's body, and the body's first block."""
    entry, first = Lines(function.append_basic_block("entry")), function.append_basic_block("body")
    buffer, begin, end, state, row, rows, numbers = function.args[: len(PARAMETERS)]
    assert isinstance(frame.failed, StoredExit)
    told = frame.failed.numbers
    done = Exit.new(entry, "done", 1)
    done.drop()
    failed = StoredExit(function.append_basic_block("failed"), tuple(state_word(entry, state, each) for each in told), told)
    series, parameters, lanes = shared.series, Parameters(buffer, begin, end, state, row), (frame.strides, frame.own_lanes)
    inside = Frame(frame.module, entry, entry.beside(first), parameters, *lanes, {}, done, failed, frame.emptied, frame.routines)
    inside.counting, inside.outcome = frame.counting, outcome
    inside.rows = rows if frame.rows is not None else None
    inside.locals.update(begin=begin, end=end, row=row)
    inside.used.update(zip(shared.hidden, function.args[len(PARAMETERS) :], strict=False))

    def number(where: ir.IRBuilder, wanted: Number) -> ir.Value:
        value = where.load(state_word(where, numbers, wanted.column), typ=I64, align=8)
        return where.add(value, constant(wanted.further)) if wanted.further else value

    columns = {column: number(entry, Number(column, 0)) for column in columns_of(series)}
    words = words_of(entry, state, series, columns)
    inside.stretch = Stretch(series.lanes, series.offsets, columns, words, series.sites, number, is_whole=True)
    for name, (type_, each) in series.constants.items():
        inside.locals[name] = entry.trunc(number(entry, each), LLVM_TYPES[type_])
    return inside, first
