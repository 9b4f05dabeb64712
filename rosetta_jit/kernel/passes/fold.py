"""Simpler expressions of the same value: constants computed, identities used. Part of `simplify`.

What is folded must not lose the bits of a NaN nor an obligation that would have failed: an operation that wraps is left as it is, for
`verify` to refuse.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any

import numpy as np

from rosetta_jit.kernel import arithmetic
from rosetta_jit.kernel.arithmetic import FLOATS, Value, limits
from rosetta_jit.kernel.nodes import Binary, Compare, Comparison, Const, Convert, Expr, Fits, Local, Scalar, Select, Unary
from rosetta_jit.kernel.terms import add, type_of
from rosetta_jit.kernel.walk import operands

COMMUTATIVE = frozenset({"add", "mul", "and", "or", "xor"})
OPPOSITE: dict[str, Comparison] = {"eq": "ne", "ne": "eq", "lt": "ge", "ge": "lt", "gt": "le", "le": "gt"}
"""The comparison that holds where one does not; of floats that may be NaN only equality has one."""

TRUE, FALSE = Const("bool", value=True), Const("bool", value=False)


def folded(expr: Expr) -> Expr:
    """An expression, its operands being folded already, in its simplest form."""
    fold = _FOLDS.get(type(expr))
    return expr if fold is None else fold(expr)


def _unary(expr: Unary) -> Expr:
    match expr:
        case Unary(_, Const()):
            return _computed(expr)
        case Unary("not", Unary("not", operand)):
            return operand
        case Unary("not", Compare(op, left, right)) if op in ("eq", "ne") or type_of(left) not in FLOATS:
            return Compare(OPPOSITE[op], left, right)
        case _:
            return expr


def _compare(expr: Compare) -> Expr:
    match expr:
        case Compare(_, Const(), Const()):
            return _computed(expr)
        case Compare(op, Local(type_, a), Local(_, b)) if a == b and type_ not in FLOATS:
            return TRUE if op in {"eq", "le", "ge"} else FALSE
        case Compare("eq", left, Const("bool", value)):
            return left if value else folded(Unary("not", left))
        case _:
            return expr


def _fits_in(expr: Fits) -> Expr:
    match expr:
        case Fits(_, Const(), Const()):
            return _computed(expr)
        case _:
            return expr


def _convert(expr: Convert) -> Expr:
    if isinstance(expr.operand, Const):
        return _computed(expr)
    return expr.operand if type_of(expr.operand) == expr.type else expr


def _select(expr: Select) -> Expr:
    match expr:
        case Select(Const(_, value), then, otherwise):
            return then if value else otherwise
        case _:
            return expr


_OF_WHOLE_NUMBERS = nullcontext()
"""Operations on them have no warnings that would have to be kept quiet, which takes longer than the operation."""


def _computed(expr: Expr) -> Expr:
    """The value of an operation on constants, unless it breaks an obligation or is a NaN."""
    quiet = np.errstate(all="ignore") if any(type_of(each) in FLOATS for each in operands(expr)) else _OF_WHOLE_NUMBERS
    try:
        with quiet:
            value = _value(expr)
    except AssertionError:
        return expr
    if isinstance(value, np.floating):
        return expr if math.isnan(value) else Const(type_of(expr), float(value))
    return Const(type_of(expr), value)


def _value(expr: Expr) -> Value:
    match expr:
        case Const(type_, value):
            return arithmetic.constant(type_, value)
        case Unary(function, operand):
            return arithmetic.unary(type_of(operand), function, _value(operand))
        case Convert(type_, operand):
            return arithmetic.convert(type_, _value(operand))
        case Binary(op, left, right):
            return arithmetic.binary(type_of(left), op, _value(left), _value(right))
        case Compare(op, left, right):
            return arithmetic.compare(op, _value(left), _value(right))
        case Fits(op, left, right):
            return arithmetic.fits(op, int(_value(left)), int(_value(right)))
        case _:
            raise AssertionError("no constant")


def _binary(expr: Binary) -> Expr:
    left, right = expr.left, expr.right
    if not isinstance(right, Const):
        swaps = isinstance(left, Const) and expr.op in COMMUTATIVE and left.type not in FLOATS
        return _binary(Binary(expr.op, right, left)) if swaps else expr
    if isinstance(left, Const):
        return _computed(expr)
    match expr:
        case Binary("sub", left, Const("i64", value)) if value != limits("i64")[0]:
            return add(left, -int(value))
        case Binary("add", Local(), Const("i64", value)) if value:
            return expr
        case Binary("add", left, Const("i64", value)):
            return _sum(left, int(value))
        case Binary(op, left, Const(type_, value)) if type_ not in FLOATS:
            return _with_constant(expr, op, left, type_, int(value))
        case _:
            return expr


def _sum(left: Expr, right: int) -> Expr:
    total = add(left, right)
    match total:
        case Const(_, value) | Binary(_, _, Const(_, value)) if not _fits(int(value)):
            return Binary("add", left, Const("i64", right))
        case _:
            return total


def _with_constant(expr: Expr, op: str, left: Expr, type_: Scalar, value: int) -> Expr:
    """Operations with a constant that leave a value as it is, or make it a constant. No operand can fail, so that it may go."""
    ones = 1 if type_ == "bool" else limits(type_)[1] if limits(type_)[0] == 0 else -1
    match op, value:
        case ("add" | "sub" | "or" | "xor" | "shl" | "shr", 0) | ("mul" | "div", 1):
            return left
        case ("mul" | "and", 0):
            return FALSE if type_ == "bool" else Const(type_, 0)
        case "and", _ if value == ones:
            return left
        case "or", _ if value == ones:
            return TRUE if type_ == "bool" else Const(type_, value)
        case _:
            return expr


def _fits(value: int) -> bool:
    low, high = limits("i64")
    return low <= value <= high


_FOLDS: dict[type[Expr], Callable[[Any], Expr]] = {
    Unary: _unary,
    Binary: _binary,
    Compare: _compare,
    Fits: _fits_in,
    Convert: _convert,
    Select: _select,
}
"""What has a simpler form, and how to find it."""
