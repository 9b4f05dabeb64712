"""Numbers as C has them."""

# pyright: reportUnusedFunction=false

from __future__ import annotations

import math
from collections.abc import Callable
from ctypes import c_float
from operator import index as _index
from struct import Struct
from typing import Any


def _within(number: Any, least: int, most: int) -> int:
    """An integer that fits its field."""
    found = _index(number)
    if not least <= found <= most:
        raise ValueError(f"{found} is not between {least} and {most}")
    return found


def _quotient(left: int, right: int) -> int:
    """Of integers, truncated toward zero."""
    result = abs(left) // abs(right)
    return result if (left < 0) == (right < 0) else -result


def _remainder(left: int, right: int) -> int:
    return left - right * _quotient(left, right)


def _single(number: float) -> float:
    """The nearest float of 32 bits."""
    return c_float(number).value


def _single_of_int(number: int) -> float:
    if -(2**53) <= number <= 2**53:
        return c_float(number).value
    shift = abs(number).bit_length() - 40
    kept = abs(number) >> shift | (abs(number) & (1 << shift) - 1 != 0)
    return math.copysign(c_float(kept).value * 2.0**shift, number)


def _divided(left: float, right: float) -> float:
    if right:
        return left / right
    if math.isnan(left) or left == 0 or math.isnan(right):
        return math.nan
    return math.copysign(math.inf, left) * math.copysign(1.0, right)


def _saturated(number: float, least: int, most: int) -> int:
    """As an integer, truncated toward zero; what does not fit becomes the nearest that does, and no number 0."""
    if math.isnan(number):
        return 0
    if math.isinf(number):
        return least if number < 0 else most
    return min(max(int(number), least), most)


def _least(left: float, right: float) -> float:
    return min(right, left)


def _most(left: float, right: float) -> float:
    return max(right, left)


def _of_math(function: Callable[..., float], *arguments: float) -> float:
    try:
        return function(*arguments)
    except ValueError:
        return math.nan


def _rounded(function: Callable[[float], int], number: float) -> float:
    """To an integer, which keeps its sign when it is 0."""
    return math.copysign(float(function(number)), number) if math.isfinite(number) else number


_BITS64 = Struct("=Q")
_FLOAT64 = Struct("=d")
_BITS32 = Struct("=I")
_FLOAT32 = Struct("=f")


def _bits64(number: float) -> int:
    return _BITS64.unpack(_FLOAT64.pack(number))[0]


def _float64(bits: int) -> float:
    return _FLOAT64.unpack(_BITS64.pack(bits))[0]


def _bits32(number: float) -> int:
    return _BITS32.unpack(_FLOAT32.pack(number))[0]


def _float32(bits: int) -> float:
    return _FLOAT32.unpack(_BITS32.pack(bits))[0]
