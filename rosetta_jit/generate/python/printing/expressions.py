"""Kernel expressions as Python expressions: integers are ints, bools are bools, floats are floats, rounded where they have 32 bits."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import assert_never

import numpy as np

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.python.passes.groups import zigzag_of
from rosetta_jit.generate.python.printing.conversions import bits_of, converted, wrapped
from rosetta_jit.generate.python.printing.scope import CODES, Scope, scaled
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.terms import END, type_of

OPERATORS = {"add": "+", "sub": "-", "mul": "*", "and": "&", "or": "|", "xor": "^", "shr": ">>"}
LOGICAL = {"and": "and", "or": "or", "xor": "!="}
COMPARISONS = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}
ROUNDINGS = {"floor": "math.floor", "ceil": "math.ceil", "trunc": "math.trunc", "rint": "round"}


def expression(scope: Scope, expr: nodes.Expr) -> str:
    """The text of an expression; one with an operator stands in parentheses."""
    match expr:
        case nodes.Const(type_, value):
            return _constant(type_, value)
        case nodes.Local(_, name):
            return "end" if name == END.name else scope.locals.identifier(name)
        case nodes.Load(type_, at, order):
            return _loaded(scope, type_, bare(expression(scope, at)), order)
        case nodes.Get(type_, place):
            text = scope.place(place, type_, lambda: expression(scope, place.row))
            return f"({text} != 0)" if type_ == "bool" and text not in scope.bools else text
        case nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return _known(scope, expr)
        case nodes.Unary(function, operand):
            return _unary(function, type_of(operand), expression(scope, operand))
        case nodes.Binary(op, left, right):
            return _shorter(scope, expr) or _binary(op, type_of(left), expression(scope, left), expression(scope, right))
        case nodes.Compare(op, left, right):
            return f"({expression(scope, left)} {COMPARISONS[op]} {expression(scope, right)})"
        case nodes.Fits(op, left, right):
            return f"({-(2**63)} <= {expression(scope, left)} {OPERATORS[op]} {expression(scope, right)} <= {2**63 - 1})"
        case nodes.Convert():
            return _converted(scope, expr)
        case nodes.Bits(type_, operand):
            return bits_of(type_, type_of(operand), expression(scope, operand))
        case nodes.Select(condition, then, otherwise):
            return f"({expression(scope, then)} if {expression(scope, condition)} else {expression(scope, otherwise)})"
        case nodes.IsText(address, size):
            return _is_text(scope, address, expression(scope, size))
        case nodes.Nearest() | nodes.Digits() | nodes.Scale():
            return _decimal(scope, expr)
        case nodes.Lookup(_, values, index):
            return f"{values!r}[{bare(expression(scope, index))}]"
        case _:
            assert_never(expr)


def _shorter(scope: Scope, expr: nodes.Binary) -> str:
    """Whether a local is between two numbers, and a difference; nothing for other expressions."""
    match expr:
        case nodes.Binary("add", left, nodes.Const(type_, value)) if value < 0 and type_ not in FLOATS:
            return f"({expression(scope, left)} - {-int(value)})"
        case nodes.Binary("and", nodes.Compare("ge", nodes.Local() as value, nodes.Const() as least), nodes.Compare("le", same, most)):
            return f"({expression(scope, least)} <= {expression(scope, value)} <= {expression(scope, most)})" if value == same else ""
        case _:
            return ""


def _converted(scope: Scope, convert: nodes.Convert) -> str:
    if (zigzag := zigzag_of(convert)) is not None:
        text = expression(scope, zigzag)
        return f"({text} >> 1 ^ -({text} & 1))"
    if isinstance(convert.operand, nodes.Get) and (flag := scope.truth_of(convert.operand.place)) is not None:
        return f"(1 if {flag} else 0)"
    if convert.type == "i64" and is_small(convert.operand, scope.small):
        return expression(scope, convert.operand)
    return converted(convert.type, type_of(convert.operand), expression(scope, convert.operand))


def is_small(expr: nodes.Expr, small: Collection[str]) -> bool:
    """Whether an integer of 64 bits without a sign is seen to be below 2**63, as some locals are."""
    match expr:
        case nodes.Const("u64", value):
            return value < 1 << 63
        case nodes.Local("u64", name):
            return name in small
        case nodes.Convert("u64", operand):
            return type_of(operand) in ("bool", "u8", "u16", "u32")
        case nodes.Binary("and", left, right):
            return type_of(expr) == "u64" and (is_small(left, small) or is_small(right, small))
        case nodes.Binary("or" | "xor", left, right):
            return is_small(left, small) and is_small(right, small)
        case nodes.Binary("shr", left, nodes.Const(_, places)):
            return type_of(left) == "u64" and (places > 0 or is_small(left, small))
        case _:
            return False


def _decimal(scope: Scope, expr: nodes.Nearest | nodes.Digits | nodes.Scale) -> str:
    match expr:
        case nodes.Nearest(address, size, exponent):
            (memory, start), count = location(scope, address), expression(scope, size)
            return f"_nearest({memory}[{start} : {start} + {count}], {bare(expression(scope, exponent))})"
        case nodes.Digits(value, None):
            return f"_shortest({_and_width(scope, value)})[0]"
        case nodes.Digits(value, places):
            return f"_fixed_digits({bare(expression(scope, value))}, {places})"
        case nodes.Scale(value):
            return f"_shortest({_and_width(scope, value)})[1]"
        case _:
            assert_never(expr)


def _and_width(scope: Scope, value: nodes.Expr) -> str:
    """A float, and how many bits it has."""
    return f"{bare(expression(scope, value))}, {8 * nodes.WIDTH[type_of(value)]}"


def _known(scope: Scope, expr: nodes.Known) -> str:
    match expr:
        case nodes.Used(lane):
            return scope.used(lane)
        case nodes.Capacity(lane):
            return scope.room(lane)
        case nodes.HostValue(what):
            scope.from_call.add(what)
            return f"call_{what}"
        case nodes.Register(number):
            scope.from_call.add("registers")
            return f"call_registers[{number}]"


def _is_text(scope: Scope, address: nodes.Address, size: str) -> str:
    memory, start = location(scope, address)
    if memory == "data":  # bytes know whether they are ASCII
        return f"(data[{start} : {start} + {size}].isascii() or _is_text(data, {start}, {bare(size)}))"
    return f"_is_text({memory}, {start}, {bare(size)})"


def _constant(type_: nodes.Scalar, value: float) -> str:
    if type_ == "bool":
        return "True" if value else "False"
    if type_ not in FLOATS:
        return str(int(value)) if value >= 0 else f"({int(value)})"
    with np.errstate(over="ignore"):
        number = float(np.float32(value)) if type_ == "f32" else float(value)
    if math.isnan(number):
        return "math.nan"
    if math.isinf(number):
        return "math.inf" if number > 0 else "(-math.inf)"
    return repr(number) if not repr(number).startswith("-") else f"({number!r})"


def _loaded(scope: Scope, type_: nodes.Scalar, at: str, order: str) -> str:
    if type_ == "u8":
        return f"data[{at}]"
    if type_ == "bool":
        return f"(data[{at}] != 0)"
    return f"{scope.struct('<' if nodes.WIDTH[type_] == 1 else order, CODES[type_], 'load')}(data, {at})[0]"


def _unary(function: str, type_: nodes.Scalar, value: str) -> str:
    match function:
        case "not" if type_ == "bool":
            return f"(not {value})"
        case "not":
            return f"(~{value})" if type_[0] == "i" else f"({value} ^ {2 ** (8 * nodes.WIDTH[type_]) - 1})"
        case "neg":
            return f"(-{value})"
        case "abs":
            return f"abs({bare(value)})"
        case _ if type_ not in FLOATS:
            return value
        case "floor" | "ceil" | "trunc" | "rint":
            return f"_rounded({ROUNDINGS[function]}, {bare(value)})"
        case _:
            return _rounded(type_, f"_of_math(math.{function}, {bare(value)})")


def _rounded(type_: nodes.Scalar, value: str) -> str:
    return f"_single({bare(value)})" if type_ == "f32" else value


def _binary(op: str, type_: nodes.Scalar, left: str, right: str) -> str:
    match op:
        case "and" | "or" | "xor" if type_ == "bool":
            return f"({left} {LOGICAL[op]} {right})"
        case "min" | "max" if type_ in FLOATS:
            return f"_{'least' if op == 'min' else 'most'}({bare(left)}, {bare(right)})"
        case "min" | "max":
            return f"{op}({bare(left)}, {bare(right)})"
        case "div":
            return (
                _rounded(type_, f"_divided({bare(left)}, {bare(right)})") if type_ in FLOATS else f"_quotient({bare(left)}, {bare(right)})"
            )
        case "rem":
            return f"_of_math(math.fmod, {left}, {right})" if type_ in FLOATS else f"_remainder({bare(left)}, {bare(right)})"
        case "atan2":
            return f"_of_math(math.atan2, {left}, {right})"
        case "wrapping_add":
            return wrapped(type_, f"({left} + {right})")
        case "shl":
            return wrapped(type_, f"({left} << {right})")
        case _:
            return _rounded(type_, f"({left} {OPERATORS[op]} {right})") if type_ in FLOATS else f"({left} {OPERATORS[op]} {right})"


def slice_of(scope: Scope, at: nodes.Expr, size: nodes.Expr) -> str:
    """Bytes of the message."""
    begin = bare(expression(scope, at))
    if isinstance(at, nodes.Const) and isinstance(size, nodes.Const):
        return f"data[{begin} : {int(at.value + size.value)}]"
    return f"data[{begin} : {_end_of(scope, at, size) or f'{begin} + {expression(scope, size)}'}]"


def _end_of(scope: Scope, at: nodes.Expr, size: nodes.Expr) -> str | None:
    """Where bytes end, if a local has that, or the place some bytes behind it."""
    match size:
        case nodes.Binary("add", more, nodes.Const(_, less)) if less < 0 and nodes.Binary("add", at, more) in scope.sums:
            return f"{scope.sums[nodes.Binary('add', at, more)]} - {-int(less)}"
        case _:
            return scope.sums.get(nodes.Binary("add", at, size))


def location(scope: Scope, address: nodes.Address) -> tuple[str, str]:
    """Memory, and the number of a byte in there."""
    match address:
        case nodes.Wire(at):
            return "data", bare(expression(scope, at))
        case nodes.Place(lane, row, offset):
            return scope.view(lane, ""), scaled(expression(scope, row), scope.lanes.stride(lane), offset)
        case _:
            assert_never(address)
