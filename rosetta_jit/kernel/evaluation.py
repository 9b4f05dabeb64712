"""What expressions of a kernel are worth, and which bytes it may touch: the half of the reference semantics that changes nothing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from rosetta_jit.kernel import arithmetic, decimals, ir, nodes
from rosetta_jit.kernel.arithmetic import Value, demand
from rosetta_jit.kernel.host import Functions
from rosetta_jit.kernel.terms import BEGIN, END, type_of
from rosetta_jit.startup.dataclass import dataclass


@dataclass(slots=True)
class Machine:
    """What an attempt sees and changes."""

    strides: tuple[int, ...]
    message: memoryview
    lanes: list[memoryview]
    capacities: list[int]
    used: list[int]
    routines: Mapping[str, ir.Routine]
    host_values: Mapping[str, int]
    registers: tuple[int, ...]
    functions: Functions
    locals: dict[str, Value]


def integer(machine: Machine, expr: nodes.Expr) -> int:
    """What an expression is worth that is an integer."""
    value = value_of(machine, expr)
    if not isinstance(value, int):
        raise AssertionError("a float where an integer belongs")  # noqa: TRY004  # our bug, not a caller's
    return value


def value_of(machine: Machine, expr: nodes.Expr) -> Value:
    """What an expression is worth."""
    match expr:
        case nodes.Const(type_, value):
            return arithmetic.constant(type_, value)
        case nodes.Local(_, name):
            return machine.locals[name]
        case nodes.Load(type_, at, order):
            return arithmetic.from_bytes(type_, bytes(bytes_at(machine, nodes.Wire(at), nodes.WIDTH[type_])), order)
        case nodes.Get(type_, place):
            return arithmetic.from_bytes(type_, bytes(field(machine, place, nodes.WIDTH[type_])))
        case nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return _known(machine, expr)
        case nodes.Unary(function, operand):
            return arithmetic.unary(type_of(operand), function, value_of(machine, operand))
        case nodes.Binary(op, left, right):
            return arithmetic.binary(type_of(left), op, value_of(machine, left), value_of(machine, right))
        case nodes.Compare(op, left, right):
            return arithmetic.compare(op, value_of(machine, left), value_of(machine, right))
        case nodes.Fits(op, left, right):
            return arithmetic.fits(op, integer(machine, left), integer(machine, right))
        case nodes.Convert(type_, operand) | nodes.Bits(type_, operand):
            value = value_of(machine, operand)
            is_bits = isinstance(expr, nodes.Bits)
            return arithmetic.same_bits(type_, type_of(operand), value) if is_bits else arithmetic.convert(type_, value)
        case nodes.Select(condition, then, otherwise):
            chosen, other = value_of(machine, then), value_of(machine, otherwise)
            return chosen if value_of(machine, condition) else other
        case nodes.IsText(address, size):
            return _is_text(bytes(bytes_at(machine, address, integer(machine, size))))
        case nodes.Nearest() | nodes.Digits() | nodes.Scale():
            return _decimal(machine, expr)
        case nodes.Lookup(_, values, index):
            number = integer(machine, index)
            demand(0 <= number < len(values), f"no value {number} among {len(values)}")
            return values[number]
        case _:
            assert_never(expr)


def _known(machine: Machine, expr: nodes.Known) -> int:
    match expr:
        case nodes.Used(lane):
            return machine.used[lane]
        case nodes.Capacity(lane):
            return machine.capacities[lane]
        case nodes.HostValue(what):
            return machine.host_values[what]
        case nodes.Register(number):
            return machine.registers[number]
        case _:
            assert_never(expr)


def _decimal(machine: Machine, expr: nodes.Nearest | nodes.Digits | nodes.Scale) -> Value:
    match expr:
        case nodes.Nearest(address, size, exponent):
            return decimals.nearest(bytes(bytes_at(machine, address, integer(machine, size))), integer(machine, exponent))
        case nodes.Digits(value, places):
            return decimals.digits(type_of(value), float(value_of(machine, value)), places)
        case nodes.Scale(value):
            return decimals.scale(type_of(value), float(value_of(machine, value)))
        case _:
            assert_never(expr)


def _is_text(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


def bytes_at(machine: Machine, address: nodes.Address, size: int) -> memoryview:
    """``size`` bytes of the message or of a lane, which must lie inside."""
    demand(size >= 0, "a negative size")
    match address:
        case nodes.Wire(at):
            start = integer(machine, at)
            low, high = integer(machine, BEGIN), integer(machine, END)
            demand(low <= start <= high - size, f"[{start}, {start + size}) is outside the message")
            return machine.message[start : start + size]
        case nodes.Place(lane, row, offset):
            stride, index = machine.strides[lane], integer(machine, row)
            start = index * stride + offset
            demand(index >= 0 <= offset, "a negative place")
            demand(start + size <= machine.capacities[lane] * stride, f"row {index} is outside lane {lane}")
            return machine.lanes[lane][start : start + size]
        case _:
            assert_never(address)


def field(machine: Machine, place: nodes.Place, width: int) -> memoryview:
    """One field of one row."""
    demand(place.offset + width <= machine.strides[place.lane], "a field outside its row")
    return bytes_at(machine, place, width)
