"""Kernel expressions as Python expressions.

Integers are ints, bools are bools. Floats are numpy scalars of their width: f32 arithmetic on them is f32, division by zero is no
exception, and one that is only moved keeps all bits of a NaN.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.state import NOW, NUMBER
from rosetta_jit.kernel.terms import is_wider, type_of
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.backends.printing import Namespace

FORMATS = {"bool": "?", "i8": "b", "u8": "B", "i16": "h", "u16": "H", "i32": "i", "u32": "I", "i64": "q", "u64": "Q"}
"""Codes of the struct module; floats go through `kernel.arithmetic`."""

OPERATORS = {"add": "+", "sub": "-", "mul": "*", "and": "&", "or": "|", "xor": "^", "shr": ">>"}
COMPARISONS = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}
TOLD = {"now": f"int(state[{NOW}])", "number": f"(int(state[{NUMBER}]) + row)"}
FLOATS = frozenset({"f32", "f64"})


@dataclass(slots=True)
class Names:
    """Identifiers of an attempt, and the lanes whose used length and capacity it reads."""

    locals: Namespace
    strides: tuple[int, ...]
    used: set[int] = field(default_factory=set[int])
    capacities: set[int] = field(default_factory=set[int])
    registers: set[int] = field(default_factory=set[int])

    def used_name(self, lane: int) -> str:
        self.used.add(lane)
        return f"used_{lane}"

    def capacity_name(self, lane: int) -> str:
        self.capacities.add(lane)
        return f"capacity_{lane}"

    def register_name(self, number: int) -> str:
        self.registers.add(number)
        return f"register_{number}"


def expression(names: Names, expr: nodes.Expr) -> str:
    """The text of an expression; one with an operator stands in parentheses."""
    match expr:
        case nodes.Const(type_, value):
            return _constant(type_, value)
        case nodes.Local(_, name):
            return names.locals.identifier(name)
        case nodes.Load(type_, at, order):
            return _read(names, type_, nodes.Wire(at), order)
        case nodes.Get(type_, place):
            return _read(names, type_, place, "<")
        case nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return _known(names, expr)
        case nodes.Unary("not", operand) if type_of(operand) == "bool":
            return f"(not {expression(names, operand)})"
        case nodes.Unary(function, operand):
            return f'unary("{type_of(operand)}", "{function}", {expression(names, operand)})'
        case nodes.Binary(op, left, right):
            return _binary(op, type_of(left), expression(names, left), expression(names, right))
        case nodes.Compare(op, left, right):
            text = f"({expression(names, left)} {COMPARISONS[op]} {expression(names, right)})"
            return f"bool{text}" if type_of(left) in FLOATS else text
        case nodes.Fits(op, left, right):
            return f'fits("{op}", {expression(names, left)}, {expression(names, right)})'
        case nodes.Convert(type_, operand) | nodes.Bits(type_, operand):
            source, text = type_of(operand), expression(names, operand)
            return f'same_bits("{type_}", "{source}", {text})' if isinstance(expr, nodes.Bits) else _convert(type_, source, text)
        case nodes.Select(condition, then, otherwise):
            return f"({expression(names, then)} if {expression(names, condition)} else {expression(names, otherwise)})"
        case nodes.IsText(address, size):
            return f"is_text({part(names, address, expression(names, size))})"
        case nodes.Nearest() | nodes.Digits() | nodes.Scale():
            return _decimal(names, expr)
        case nodes.Lookup(_, values, index):
            return f"{values!r}[{expression(names, index)}]"
        case _:
            assert_never(expr)


def _known(names: Names, expr: nodes.Known) -> str:
    match expr:
        case nodes.Used(lane):
            return names.used_name(lane)
        case nodes.Capacity(lane):
            return names.capacity_name(lane)
        case nodes.HostValue(what):
            return TOLD[what]
        case nodes.Register(number):
            return names.register_name(number)
        case _:
            assert_never(expr)


def _decimal(names: Names, expr: nodes.Nearest | nodes.Digits | nodes.Scale) -> str:
    match expr:
        case nodes.Nearest(address, size, exponent):
            return f"nearest({part(names, address, expression(names, size))}, {expression(names, exponent)})"
        case nodes.Digits(value, places):
            return f'digits("{type_of(value)}", {expression(names, value)}, {places})'
        case nodes.Scale(value):
            return f'scale("{type_of(value)}", {expression(names, value)})'
        case _:
            assert_never(expr)


def part(names: Names, address: nodes.Address, size: str) -> str:
    """A slice of the message or of a lane."""
    memory, start = location(names, address)
    return f"{memory}[{start} : {start} + {size}]"


def location(names: Names, address: nodes.Address) -> tuple[str, str]:
    """The memory and the index of its byte."""
    match address:
        case nodes.Wire(at):
            return "buffer", expression(names, at)
        case nodes.Place(lane, row, offset):
            stride = names.strides[lane]
            start = expression(names, row) if stride == 1 else f"{expression(names, row)} * {stride}"
            return f"lanes[{lane}]", f"{start} + {offset}" if offset else start
        case _:
            assert_never(address)


def _constant(type_: nodes.Scalar, value: float) -> str:
    if type_ not in FLOATS:
        return repr(bool(value)) if type_ == "bool" else repr(int(value))
    number = repr(float(value))
    return f"float{8 * nodes.WIDTH[type_]}({number if math.isfinite(value) else repr(number)})"


def _read(names: Names, type_: nodes.Scalar, address: nodes.Address, order: str) -> str:
    if type_ in FLOATS:
        return f'from_bytes("{type_}", bytes({part(names, address, str(nodes.WIDTH[type_]))}), "{order}")'
    memory, start = location(names, address)
    return f'unpack_from("{order}{FORMATS[type_]}", {memory}, {start})[0]'


def _binary(op: str, type_: nodes.Scalar, left: str, right: str) -> str:
    match op, type_ in FLOATS:
        case (("min" | "max" | "rem" | "atan2"), True):
            return f'binary("{type_}", "{op}", {left}, {right})'
        case "div", True:
            return f"({left} / {right})"
        case (("min" | "max"), False):
            return f"{op}({left}, {right})"
        case "div", False:
            return f"quotient({left}, {right})"
        case "rem", False:
            return f"remainder({left}, {right})"
        case "wrapping_add", _:
            return f'wrapped("{type_}", {left} + {right})'
        case "shl", _:
            return f'wrapped("{type_}", {left} << {right})'
        case _:
            return f"({left} {OPERATORS[op]} {right})"


def _convert(target: nodes.Scalar, source: nodes.Scalar, value: str) -> str:
    """Nothing where every value of the source is one of the target."""
    is_whole = source not in FLOATS | {"bool"} and target not in FLOATS | {"bool"} and is_wider(target, source)
    return value if is_whole or target == source else f'convert("{target}", {value})'
