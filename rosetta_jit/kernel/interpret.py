"""The reference semantics: runs a kernel as `ir` describes it, slowly, and asserts every obligation on the way."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, assert_never

import numpy as np

from rosetta_jit.kernel import arithmetic, decimals
from rosetta_jit.kernel.arithmetic import demand
from rosetta_jit.kernel.host import NO_FUNCTIONS, RefusedError
from rosetta_jit.kernel.ir import (
    WIDTH,
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
    Fill,
    Fits,
    For,
    Get,
    HostCall,
    If,
    IsText,
    Let,
    Load,
    Local,
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
    Told,
    Unary,
    Used,
    Var,
    While,
    Wire,
)
from rosetta_jit.kernel.shape import extents_of
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
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, MutableSequence, Sequence

    from rosetta_jit.kernel.arithmetic import Value
    from rosetta_jit.kernel.host import Functions
    from rosetta_jit.kernel.ir import Address, Block, Expr, Failure, Kernel, Known, Routine, Stmt

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


@dataclass(slots=True)
class _Machine:
    """What an attempt sees and changes."""

    strides: tuple[int, ...]
    message: memoryview
    lanes: list[memoryview]
    capacities: list[int]
    used: list[int]
    routines: Mapping[str, Routine]
    told: Mapping[str, int]
    registers: tuple[int, ...]
    functions: Functions
    locals: dict[str, Value]


def runnable(kernel: Kernel, functions: Functions) -> Callable[..., int]:
    """A kernel as a function that runs it; ``functions`` are those of the host."""
    return partial(run, kernel, functions=functions)


def run(
    kernel: Kernel,
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


def _machine(kernel: Kernel, buffer: Memory, state: State, lanes: Sequence[Memory], row: int, functions: Functions) -> _Machine:
    """What each attempt starts with."""
    views = [memoryview(lane).cast("B") for lane in lanes]
    views += [memoryview(bytearray())] * (len(kernel.strides) - len(views))
    own, hidden = range(kernel.lanes), range(kernel.lanes, len(kernel.strides))
    capacities = [int(state[lane_word(k, CAPACITY)]) for k in own] + [len(views[k]) // kernel.strides[k] for k in hidden]
    starts_empty = kernel.direction == "decode" and row == 0
    used = [0 if starts_empty and k else int(state[lane_word(k, USED)]) for k in own] + [0 for _ in hidden]
    routines = {routine.name: routine for routine in kernel.routines}
    told = {"now": int(state[NOW]), "number": int(state[NUMBER]) + row}
    return _Machine(kernel.strides, memoryview(buffer).cast("B"), views, capacities, used, routines, told, (), functions, {})


def _report(state: State, failed: _Failed) -> int:
    state[ERROR_OFFSET], state[ERROR_SITE] = failed.offset, failed.site
    for k, value in enumerate(failed.indices):
        state[ERROR_INDICES + k] = value
    return -1 - failed.site


def _block(machine: _Machine, block: Block) -> _Outcome:
    for stmt in block:
        outcome = _statement(machine, stmt)
        if outcome is not None:
            return outcome
    return None


def _statement(machine: _Machine, stmt: Stmt) -> _Outcome:
    match stmt:
        case Require(at, size, failure):
            start, length = _integer(machine, at), _integer(machine, size)
            inside = start >= 0 and length >= 0 and start + length <= _integer(machine, END)
            return None if inside else _failed(machine, failure)
        case Expect(condition, failure):
            return None if _value(machine, condition) else _failed(machine, failure)
        case Let(name, value) | Var(name, value) | Assign(name, value):
            machine.locals[name] = _value(machine, value)
            return None
        case Return(position, registers):
            changed = tuple((number, _integer(machine, value)) for number, value in registers)
            return _Done(_integer(machine, position), changed)
        case Reserve(lane, count):
            rows = _integer(machine, count)
            demand(rows >= 0, "a negative count of rows")
            room = machine.capacities[lane] - machine.used[lane]
            return None if rows <= room else _Full(lane, rows - room)
        case Advance(lane, count):
            rows = _integer(machine, count)
            demand(0 <= rows <= machine.capacities[lane] - machine.used[lane], "rows that were not reserved")
            machine.used[lane] += rows
            return None
        case Store() | SetField() | Copy() | Fill():
            return _effect(machine, stmt)
        case For() | While() | If() | Switch():
            return _nested(machine, stmt)
        case Call():
            return _call(machine, stmt)
        case HostCall():
            return _host_call(machine, stmt)
        case _:
            assert_never(stmt)


def _call(machine: _Machine, call: Call) -> _Outcome:
    routine = machine.routines[call.routine]
    names = BEGIN.name, END.name, *(parameter.name for parameter in routine.parameters)
    values = (_value(machine, expr) for expr in (BEGIN, END, *call.arguments))
    inner = replace(machine, locals=dict(zip(names, values, strict=True)))
    demand(all(_value(inner, required) for required in routine.requires), "a call that asks for what is not there")
    outcome = _block(inner, routine.body)
    if isinstance(outcome, _Failed):
        return _Failed(outcome.offset, call.sites[outcome.site - 1], tuple(_integer(machine, i) for i in call.indices))
    demand(all(_value(inner, ensured) for ensured in routine.ensures), "a routine that breaks its promise")
    for local, result in zip(call.results, routine.results, strict=True):
        machine.locals[local.name] = inner.locals[result.name]
    return outcome


def _host_call(machine: _Machine, call: HostCall) -> _Failed | None:
    given = [_value(machine, argument) for argument in call.arguments]
    extents = [_bytes(machine, each.address, _integer(machine, each.size)) for each in extents_of(call)]
    read = extents[: len(call.inputs)]
    try:
        found = machine.functions[call.function](*given, *(part.toreadonly() for part in read), *extents[len(call.inputs) :])
    except RefusedError:
        return _failed(machine, call.failure)
    machine.locals[call.result.name] = found
    return None


def _effect(machine: _Machine, stmt: Store | SetField | Copy | Fill) -> None:
    match stmt:
        case Store(at, value, order):
            type_ = type_of(value)
            _bytes(machine, Wire(at), WIDTH[type_])[:] = arithmetic.to_bytes(type_, _value(machine, value), order)
        case SetField(place, value):
            type_ = type_of(value)
            _field(machine, place, WIDTH[type_])[:] = arithmetic.to_bytes(type_, _value(machine, value))
        case Copy(target, source, size):
            length = _integer(machine, size)
            _bytes(machine, target, length)[:] = bytes(_bytes(machine, source, length))
        case Fill(target, size, byte):
            length = _integer(machine, size)
            _bytes(machine, target, length)[:] = bytes([byte]) * length
        case _:
            assert_never(stmt)


def _nested(machine: _Machine, stmt: For | While | If | Switch) -> _Outcome:
    match stmt:
        case For(variable, count, body):
            for index in range(_integer(machine, count)):
                machine.locals[variable] = index
                outcome = _block(machine, body)
                if outcome is not None:
                    return outcome
            return None
        case While():
            return _while(machine, stmt)
        case If(condition, then, otherwise):
            return _block(machine, then if _value(machine, condition) else otherwise)
        case Switch(value, cases, default):
            return _block(machine, dict(cases).get(_integer(machine, value), default))
        case _:
            assert_never(stmt)


def _while(machine: _Machine, loop: While) -> _Outcome:
    while True:
        demand(all(_value(machine, kept) for kept in loop.invariant), "an invariant does not hold")
        if not _value(machine, loop.condition):
            return None
        before = _integer(machine, loop.measure)
        outcome = _block(machine, loop.body)
        if outcome is not None:
            return outcome
        demand(_integer(machine, loop.measure) > before, "a round made no progress")


def _failed(machine: _Machine, failure: Failure) -> _Failed:
    return _Failed(_integer(machine, failure.at), failure.site, tuple(_integer(machine, i) for i in failure.indices))


def _integer(machine: _Machine, expr: Expr) -> int:
    value = _value(machine, expr)
    if not isinstance(value, int):
        raise AssertionError("a float where an integer belongs")  # noqa: TRY004  # our bug, not a caller's
    return value


def _value(machine: _Machine, expr: Expr) -> Value:
    match expr:
        case Const(type_, value):
            return arithmetic.constant(type_, value)
        case Local(_, name):
            return machine.locals[name]
        case Load(type_, at, order):
            return arithmetic.from_bytes(type_, bytes(_bytes(machine, Wire(at), WIDTH[type_])), order)
        case Get(type_, place):
            return arithmetic.from_bytes(type_, bytes(_field(machine, place, WIDTH[type_])))
        case Used() | Capacity() | Told() | Register():
            return _known(machine, expr)
        case Unary(function, operand):
            return arithmetic.unary(type_of(operand), function, _value(machine, operand))
        case Binary(op, left, right):
            return arithmetic.binary(type_of(left), op, _value(machine, left), _value(machine, right))
        case Compare(op, left, right):
            return arithmetic.compare(op, _value(machine, left), _value(machine, right))
        case Fits(op, left, right):
            return arithmetic.fits(op, _integer(machine, left), _integer(machine, right))
        case Convert(type_, operand) | Bits(type_, operand):
            value = _value(machine, operand)
            is_bits = isinstance(expr, Bits)
            return arithmetic.same_bits(type_, type_of(operand), value) if is_bits else arithmetic.convert(type_, value)
        case Select(condition, then, otherwise):
            chosen, other = _value(machine, then), _value(machine, otherwise)
            return chosen if _value(machine, condition) else other
        case IsText(address, size):
            return _is_text(bytes(_bytes(machine, address, _integer(machine, size))))
        case Nearest() | Digits() | Scale():
            return _decimal(machine, expr)
        case _:
            assert_never(expr)


def _known(machine: _Machine, expr: Known) -> int:
    match expr:
        case Used(lane):
            return machine.used[lane]
        case Capacity(lane):
            return machine.capacities[lane]
        case Told(what):
            return machine.told[what]
        case Register(number):
            return machine.registers[number]
        case _:
            assert_never(expr)


def _decimal(machine: _Machine, expr: Nearest | Digits | Scale) -> Value:
    match expr:
        case Nearest(address, size, exponent):
            return decimals.nearest(bytes(_bytes(machine, address, _integer(machine, size))), _integer(machine, exponent))
        case Digits(value, places):
            return decimals.digits(type_of(value), float(_value(machine, value)), places)
        case Scale(value):
            return decimals.scale(type_of(value), float(_value(machine, value)))
        case _:
            assert_never(expr)


def _is_text(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


def _bytes(machine: _Machine, address: Address, size: int) -> memoryview:
    """``size`` bytes of the message or of a lane, which must lie inside."""
    demand(size >= 0, "a negative size")
    match address:
        case Wire(at):
            start = _integer(machine, at)
            low, high = _integer(machine, BEGIN), _integer(machine, END)
            demand(low <= start <= high - size, f"[{start}, {start + size}) is outside the message")
            return machine.message[start : start + size]
        case Place(lane, row, offset):
            stride, index = machine.strides[lane], _integer(machine, row)
            start = index * stride + offset
            demand(index >= 0 <= offset, "a negative place")
            demand(start + size <= machine.capacities[lane] * stride, f"row {index} is outside lane {lane}")
            return machine.lanes[lane][start : start + size]
        case _:
            assert_never(address)


def _field(machine: _Machine, place: Place, width: int) -> memoryview:
    """One field of one row."""
    demand(place.offset + width <= machine.strides[place.lane], "a field outside its row")
    return _bytes(machine, place, width)
