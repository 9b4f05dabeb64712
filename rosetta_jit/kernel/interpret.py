"""The reference semantics: runs a kernel as `ir` describes it, slowly, and asserts every obligation on the way."""

from __future__ import annotations

from collections.abc import Callable, MutableSequence, Sequence
from functools import partial
from typing import TYPE_CHECKING, assert_never

import numpy as np

from rosetta_jit.kernel import arithmetic, ir, nodes
from rosetta_jit.kernel.arithmetic import demand
from rosetta_jit.kernel.evaluation import Machine, bytes_at, field, integer, value_of
from rosetta_jit.kernel.host import NO_FUNCTIONS, Functions, RefusedError
from rosetta_jit.kernel.state import (
    CAPACITY,
    ERROR_INDICES,
    ERROR_OFFSET,
    ERROR_SITE,
    GROW,
    GROW_LANE,
    GROW_ROWS,
    NOW,
    NUMBER,
    USED,
    lane_word,
)
from rosetta_jit.kernel.terms import BEGIN, END, type_of
from rosetta_jit.kernel.walk import extents_of
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    Memory = bytes | bytearray | memoryview
    State = np.ndarray[tuple[int], np.dtype[np.int64]]


@dataclass(frozen=True, slots=True)
class _Failed:
    """How an attempt failed."""

    offset: int
    site: int
    indices: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class _Full:
    """The lane that must grow, and the rows that it lacks."""

    lane: int
    missing: int


@dataclass(frozen=True, slots=True)
class _Done:
    """The position that was returned, and what registers hold from now on."""

    position: int
    registers: tuple[tuple[int, int], ...]


_Outcome = _Done | _Failed | _Full | None
"""What a statement did: a message done, a failure, a full lane, or None to go on."""


def runnable(kernel: ir.Kernel, functions: Functions) -> Callable[..., int]:
    """A kernel as a function that runs it; ``functions`` are those of the host."""
    return partial(run, kernel, functions=functions)


def run(
    kernel: ir.Kernel,
    buffer: Memory,
    begin: int,
    end: int,
    state: State,
    lanes: Sequence[Memory],
    row: int,
    registers: MutableSequence[int] | None = None,
    *,
    functions: Functions = NO_FUNCTIONS,
) -> int:
    """Run a kernel.

    Parameters
    ----------
    kernel
        A verified kernel.
    buffer
        The buffer that holds the message; written by kernels that encode.
    begin, end
        Where the message (to encode: the room for it) begins and ends in the buffer, in bytes.
    state
        int64 words of the holder, as in `kernel.state`; capacities and used lengths are read from it.
    lanes
        The bytes of each lane (anything with a buffer; of an array its ``data``); of hidden ones as many as there are.
    row
        Row of lane 0 that stands for the message.
    registers
        Those of the kernel's program, as many as the kernel says; None where it has none. A Return changes them.
    functions
        Those of the host.

    Returns
    -------
    int
        The position reached, or -1 - site.

    Raises
    ------
    AssertionError
        The kernel broke an obligation that `verify` proves: a bug of ours.
    """
    fresh = _machine(kernel, buffer, state, lanes, row, functions)
    kept = () if registers is None else tuple(map(int, registers[: kernel.registers]))
    worst: _Failed | None = None
    for body in kernel.bodies:
        machine = replace(fresh, used=list(fresh.used), registers=kept, locals={"begin": begin, "end": end, "row": row})
        with np.errstate(all="ignore"):
            outcome = _block(machine, body)
        match outcome:
            case _Done(position, changed):
                for lane, rows in enumerate(machine.used[: kernel.lanes]):
                    state[lane_word(lane, USED)] = rows
                for number, value in changed:
                    assert registers is not None, "a kernel that changes registers is given them"
                    registers[number] = value
                return position
            case _Full(lane, missing):
                state[GROW_LANE], state[GROW_ROWS] = lane, missing if lane < kernel.lanes else missing * kernel.strides[lane]
                return GROW
            case _Failed():
                worst = outcome if worst is None or outcome.offset > worst.offset else worst
            case None:
                raise AssertionError("a body ended without Return")
            case _:
                assert_never(outcome)
    if worst is None:
        raise AssertionError("a kernel without bodies")
    return _report(state, worst)


def _machine(kernel: ir.Kernel, buffer: Memory, state: State, lanes: Sequence[Memory], row: int, functions: Functions) -> Machine:
    """What each attempt starts with."""
    views = [memoryview(lane).cast("B") for lane in lanes]
    views += [memoryview(bytearray())] * (len(kernel.strides) - len(views))
    own, hidden = range(kernel.lanes), range(kernel.lanes, len(kernel.strides))
    capacities = [int(state[lane_word(k, CAPACITY)]) for k in own] + [len(views[k]) // kernel.strides[k] for k in hidden]
    starts_empty = kernel.direction == "decode" and row == 0
    used = [0 if starts_empty and k and k not in kernel.kept else int(state[lane_word(k, USED)]) for k in own] + [0 for _ in hidden]
    routines = {routine.name: routine for routine in kernel.routines}
    host_values = {"now": int(state[NOW]), "number": int(state[NUMBER]) + row}
    return Machine(kernel.strides, memoryview(buffer).cast("B"), views, capacities, used, routines, host_values, (), functions, {})


def _report(state: State, failed: _Failed) -> int:
    state[ERROR_OFFSET], state[ERROR_SITE] = failed.offset, failed.site
    for k, value in enumerate(failed.indices):
        state[ERROR_INDICES + k] = value
    return -1 - failed.site


def _block(machine: Machine, block: nodes.Block) -> _Outcome:
    for stmt in block:
        outcome = _statement(machine, stmt)
        if outcome is not None:
            return outcome
    return None


def _statement(machine: Machine, stmt: nodes.Stmt) -> _Outcome:
    match stmt:
        case nodes.Require(at, size, failure):
            start, length = integer(machine, at), integer(machine, size)
            inside = start >= 0 and length >= 0 and start + length <= integer(machine, END)
            return None if inside else _failed(machine, failure)
        case nodes.Expect(condition, failure):
            return None if value_of(machine, condition) else _failed(machine, failure)
        case nodes.Let(name, value) | nodes.Var(name, value) | nodes.Assign(name, value):
            machine.locals[name] = value_of(machine, value)
            return None
        case nodes.Return(position, registers):
            changed = tuple((number, integer(machine, value)) for number, value in registers)
            return _Done(integer(machine, position), changed)
        case nodes.Reserve(lane, count):
            rows = integer(machine, count)
            demand(rows >= 0, "a negative count of rows")
            room = machine.capacities[lane] - machine.used[lane]
            return None if rows <= room else _Full(lane, rows - room)
        case nodes.Advance(lane, count):
            rows = integer(machine, count)
            demand(0 <= rows <= machine.capacities[lane] - machine.used[lane], "rows that were not reserved")
            machine.used[lane] += rows
            return None
        case nodes.Store() | nodes.SetField() | nodes.Copy() | nodes.Fill():
            return _effect(machine, stmt)
        case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
            return _nested(machine, stmt)
        case nodes.Call():
            return _call(machine, stmt)
        case nodes.HostCall():
            return _host_call(machine, stmt)
        case _:
            assert_never(stmt)


def _call(machine: Machine, call: nodes.Call) -> _Outcome:
    routine = machine.routines[call.routine]
    names = BEGIN.name, END.name, *(parameter.name for parameter in routine.parameters)
    values = (value_of(machine, expr) for expr in (BEGIN, END, *call.arguments))
    inner = replace(machine, locals=dict(zip(names, values, strict=True)))
    demand(all(value_of(inner, required) for required in routine.requires), "a call that asks for what is not there")
    outcome = _block(inner, routine.body)
    if isinstance(outcome, _Failed):
        return _Failed(outcome.offset, call.sites[outcome.site - 1], tuple(integer(machine, i) for i in call.indices))
    demand(all(value_of(inner, ensured) for ensured in routine.ensures), "a routine that breaks its promise")
    for local, result in zip(call.results, routine.results, strict=True):
        machine.locals[local.name] = inner.locals[result.name]
    return outcome


def _host_call(machine: Machine, call: nodes.HostCall) -> _Failed | None:
    arguments = [value_of(machine, argument) for argument in call.arguments]
    extents = [bytes_at(machine, each.address, integer(machine, each.size)) for each in extents_of(call)]
    read = extents[: len(call.inputs)]
    try:
        found = machine.functions[call.function](*arguments, *(part.toreadonly() for part in read), *extents[len(call.inputs) :])
    except RefusedError:
        return _failed(machine, call.failure)
    machine.locals[call.result.name] = found
    return None


def _effect(machine: Machine, stmt: nodes.Store | nodes.SetField | nodes.Copy | nodes.Fill) -> None:
    match stmt:
        case nodes.Store(at, value, order):
            type_ = type_of(value)
            bytes_at(machine, nodes.Wire(at), nodes.WIDTH[type_])[:] = arithmetic.to_bytes(type_, value_of(machine, value), order)
        case nodes.SetField(place, value):
            type_ = type_of(value)
            field(machine, place, nodes.WIDTH[type_])[:] = arithmetic.to_bytes(type_, value_of(machine, value))
        case nodes.Copy(target, source, size):
            length = integer(machine, size)
            bytes_at(machine, target, length)[:] = bytes(bytes_at(machine, source, length))
        case nodes.Fill(target, size, byte):
            length = integer(machine, size)
            bytes_at(machine, target, length)[:] = bytes([byte]) * length
        case _:
            assert_never(stmt)


def _nested(machine: Machine, stmt: nodes.For | nodes.While | nodes.If | nodes.Switch) -> _Outcome:
    match stmt:
        case nodes.For(variable, count, body):
            for index in range(integer(machine, count)):
                machine.locals[variable] = index
                outcome = _block(machine, body)
                if outcome is not None:
                    return outcome
            return None
        case nodes.While():
            return _while(machine, stmt)
        case nodes.If(condition, then, otherwise):
            return _block(machine, then if value_of(machine, condition) else otherwise)
        case nodes.Switch(value, cases, default):
            return _block(machine, dict(cases).get(integer(machine, value), default))
        case _:
            assert_never(stmt)


def _while(machine: Machine, loop: nodes.While) -> _Outcome:
    while True:
        demand(all(value_of(machine, kept) for kept in loop.invariant), "an invariant does not hold")
        if not value_of(machine, loop.condition):
            return None
        before = integer(machine, loop.measure)
        outcome = _block(machine, loop.body)
        if outcome is not None:
            return outcome
        demand(integer(machine, loop.measure) > before, "a round made no progress")


def _failed(machine: Machine, failure: nodes.Failure) -> _Failed:
    return _Failed(integer(machine, failure.at), failure.site, tuple(integer(machine, i) for i in failure.indices))
