"""A value as it is written, to a constant of the type that it is for: defaults and options."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.frameworks.protobuf.proto.tree import Aggregate, Listing, Value, Word
from rosetta_jit.model.types import Bool, Bytes, Constant, Float, Int, String

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.proto.scalars import Scalar

NOT_FINITE = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan, "-nan": math.nan}


class WrongValueError(ValueError):
    """The value is none of its type; ``args[0]`` says what is wanted."""


def constant(type_: Scalar, value: Value) -> Constant:
    """The constant of a scalar type; raises WrongValueError."""
    match type_, value:
        case Bool(), Word("true" | "false" as word):
            return word == "true"
        case Int(bits, signed), int() if fits(value, bits, signed=signed):
            return value
        case Float(bits), int() | float():
            return _rounded(float(value), bits)
        case Float(), Word(word) if word in NOT_FINITE:
            return NOT_FINITE[word]
        case Bytes(), bytes():
            return value
        case String(), bytes():
            return _text(value)
        case _:
            raise WrongValueError(_wanted(type_))


def enum_number(numbers: Mapping[str, int], value: Value) -> int:
    """The number of the value of an enum that a word names; raises WrongValueError."""
    match value:
        case Word(text) if text in numbers:
            return numbers[text]
        case _:
            raise WrongValueError("a value of the enum")


def spelled(value: Value) -> str:
    """A value as a message shows it."""
    match value:
        case Word(text):
            return text
        case Aggregate():
            return "{...}"
        case Listing():
            return "[...]"
        case bytes():
            return f'"{value.decode(errors="backslashreplace")}"'
        case int() | float():
            return repr(value)
        case _:
            assert_never(value)


def fits(value: int, bits: int, *, signed: bool) -> bool:
    """Whether an integer can be held."""
    return -(1 << bits - 1) <= value < 1 << bits - 1 if signed else 0 <= value < 1 << bits


def _rounded(value: float, bits: int) -> float:
    """The nearest number of the type: `0.1` of a float is what its 32 bits hold."""
    if bits == 64 or not math.isfinite(value):
        return value
    try:
        return struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        return math.copysign(math.inf, value)


def _text(value: bytes) -> str:
    try:
        return value.decode()
    except UnicodeDecodeError:
        raise WrongValueError("a string in UTF-8") from None


def _wanted(type_: Scalar) -> str:
    match type_:
        case Bool():
            return "`true` or `false`"
        case Int(bits, signed):
            low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
            return f"an integer from {low} to {high}"
        case Float():
            return "a number"
        case String():
            return "a string in UTF-8"
        case Bytes():
            return "a string"
        case _:
            assert_never(type_)
