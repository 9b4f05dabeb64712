"""The kernel's arithmetic on single values: integers are ints, bools bools, floats numpy scalars of their width.

Ints are exact, so that a result outside its type is seen. Floats are numpy scalars because a numpy scalar keeps the bits of a
NaN that is only moved, and because f32 arithmetic on it is f32.
"""

from __future__ import annotations

import math
from typing import assert_never

import numpy as np

from rosetta_jit.kernel.nodes import WIDTH, Arithmetic, Comparison, Function, Order, Scalar

Value = int | bool | np.float32 | np.float64

SIGNED = {"i8", "i16", "i32", "i64"}
FLOATS = {"f32", "f64"}

MOST_DIGITS, LARGEST_SCALE = 10**17, 400
"""Bounds of the shortest digits of a float and of their scale: the least float64 is 5e-324."""


_LIMITS: dict[str, tuple[int, int]] = {
    "bool": (0, 1),
    **{f"i{bits}": (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) for bits in (8, 16, 32, 64)},
    **{f"u{bits}": (0, (1 << bits) - 1) for bits in (8, 16, 32, 64)},
}


def demand(holds: bool, otherwise: str) -> None:
    """Assert what `verify` proves of every kernel."""
    if not holds:
        raise AssertionError(otherwise)


def limits(type_: Scalar) -> tuple[int, int]:
    """Least and greatest value of an integer type (or bool)."""
    return _LIMITS[type_]


def constant(type_: Scalar, value: float) -> Value:
    """A literal as a value of its type."""
    match type_:
        case "f32":
            return np.float32(value)
        case "f64":
            return np.float64(value)
        case "bool":
            return bool(value)
        case _:
            return checked(type_, int(value))


def checked(type_: Scalar, value: int) -> int:
    """``value``, which must be in the range of its type."""
    low, high = limits(type_)
    if not low <= value <= high:
        raise AssertionError(f"{value} is no {type_}: an operation wrapped")
    return value


def wrapped(type_: Scalar, value: int) -> int:
    """The low bits of an integer, read as an integer of a type."""
    bits = 8 * WIDTH[type_]
    low = value & ((1 << bits) - 1)
    return low - (1 << bits) if type_ in SIGNED and low >> (bits - 1) else low


def from_bytes(type_: Scalar, data: bytes, order: Order = "<") -> Value:
    """The scalar that lies in ``data``, its NaN payload kept."""
    if type_ in FLOATS:
        little = data if order == "<" else data[::-1]
        return np.frombuffer(little, "<f4" if type_ == "f32" else "<f8")[0]
    number = int.from_bytes(data, "little" if order == "<" else "big", signed=type_ in SIGNED)
    return number != 0 if type_ == "bool" else number


def to_bytes(type_: Scalar, value: Value, order: Order = "<") -> bytes:
    """A scalar as it lies in memory."""
    if isinstance(value, np.floating):
        little = np.array([value], "<f4" if type_ == "f32" else "<f8").tobytes()
        return little if order == "<" else little[::-1]
    return int(value).to_bytes(WIDTH[type_], "little" if order == "<" else "big", signed=type_ in SIGNED)


def same_bits(target: Scalar, source: Scalar, value: Value) -> Value:
    """The bits of a scalar as another type."""
    return from_bytes(target, to_bytes(source, value))


def binary(type_: Scalar, op: Arithmetic, left: Value, right: Value) -> Value:
    """``left op right`` of two values of one type."""
    if isinstance(left, np.floating):
        return _float_binary(op, left, right)
    result = _integer_binary(type_, op, int(left), int(right))
    return bool(result) if type_ == "bool" else checked(type_, result)


def _integer_binary(type_: Scalar, op: Arithmetic, left: int, right: int) -> int:
    match op:
        case "add":
            return left + right
        case "wrapping_add":
            return wrapped(type_, left + right)
        case "sub":
            return left - right
        case "mul":
            return left * right
        case "div":
            demand(right != 0, "division by zero")
            quotient = abs(left) // abs(right)
            return quotient if (left < 0) == (right < 0) else -quotient
        case "rem":
            return left - right * _integer_binary(type_, "div", left, right)
        case "and":
            return left & right
        case "or":
            return left | right
        case "xor":
            return left ^ right
        case "shl" | "shr":
            demand(0 <= right < 8 * WIDTH[type_], f"a shift by {right}")
            return wrapped(type_, left << right) if op == "shl" else left >> right
        case "min":
            return min(left, right)
        case "max":
            return max(left, right)
        case "atan2":
            raise AssertionError("atan2 of integers")
        case _:
            assert_never(op)


def _float_binary(op: Arithmetic, left: np.floating, right: Value) -> Value:
    match op:
        case "add":
            return left + right  # pyright: ignore[reportReturnType]  # numpy's stubs widen the sum of two float32
        case "sub":
            return left - right  # pyright: ignore[reportReturnType]  # as above
        case "mul":
            return left * right  # pyright: ignore[reportReturnType]  # as above
        case "div":
            return left / right  # pyright: ignore[reportReturnType]  # as above
        case "rem":
            return np.fmod(left, right)
        case "min":
            return left if compare("lt", left, right) else right
        case "max":
            return left if compare("gt", left, right) else right
        case "atan2":
            return np.float64(math.atan2(float(left), float(right)))
        case _:
            raise AssertionError(f"{op} of floats")


def unary(type_: Scalar, function: Function, value: Value) -> Value:
    """``function(value)``, of the operand's type."""
    match function:
        case "neg":
            return -value if type_ in FLOATS else checked(type_, -int(value))
        case "abs":
            return abs(value) if type_ in FLOATS else checked(type_, abs(int(value)))
        case "not":
            return not value if type_ == "bool" else wrapped(type_, ~int(value))
        case "sqrt" | "floor" | "ceil" | "trunc" | "rint":
            demand(type_ in FLOATS, f"{function} of {type_}")
            return getattr(np, function)(value)
        case "sin" | "cos" | "tan" | "asin" | "acos" | "atan":
            demand(type_ == "f64", f"{function} of {type_}")
            return np.float64(_angular(function, float(value)))
        case _:
            assert_never(function)


def _angular(function: str, value: float) -> float:
    """As the C library has it: NaN where there is no value."""
    try:
        return getattr(math, function)(value)
    except ValueError:
        return math.nan


def compare(op: Comparison, left: Value, right: Value) -> bool:
    """``left op right``; NaN is unequal to all and not ordered."""
    match op:
        case "eq":
            return bool(left == right)
        case "ne":
            return bool(left != right)
        case "lt":
            return bool(left < right)
        case "le":
            return bool(left <= right)
        case "gt":
            return bool(left > right)
        case "ge":
            return bool(left >= right)
        case _:
            assert_never(op)


def fits(op: Arithmetic, left: int, right: int) -> bool:
    """Whether ``left op right`` is an i64."""
    low, high = limits("i64")
    return low <= _integer_binary("i64", op, left, right) <= high


def convert(target: Scalar, value: Value) -> Value:
    """``value`` as another type, by the rules of `ir`."""
    if target == "bool":
        return bool(value != 0)
    if target in FLOATS:
        return _to_float(target, value)
    if isinstance(value, np.floating):
        return _saturated(target, float(value))
    return wrapped(target, int(value))


def _to_float(target: Scalar, value: Value) -> Value:
    if isinstance(value, np.floating):
        return np.float32(value) if target == "f32" else np.float64(value)
    # An i64 goes to f32 in one rounding: by way of a Python float there would be two.
    exact = np.int64(value) if value < 1 << 63 else np.uint64(value)
    return exact.astype(np.float32 if target == "f32" else np.float64)


def _saturated(target: Scalar, value: float) -> int:
    low, high = limits(target)
    if math.isnan(value):
        return 0
    if math.isinf(value):
        return high if value > 0 else low
    return min(max(math.trunc(value), low), high)
