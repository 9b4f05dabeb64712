"""What may be assigned to a field: one function a type, with the errors that protobuf's Python classes raise.

Numbers come from whatever Python takes for an integer or a float (numpy's scalars among it), but never from text, an integer never from
a float or a boolean, and never out of range.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from operator import index
from typing import Any, SupportsFloat, SupportsIndex, assert_never, cast

import numpy as np

from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Enum, Float, Int, String
from rosetta_jit.runtime.cells import dtype_of
from rosetta_jit.runtime.holder.record import ScalarType

UTF_16 = "utf-16-le" if sys.byteorder == "little" else "utf-16-be"
"""How the code units of strings lie in lanes. Surrogates without a partner are code units too."""


def scalar(type_: ScalarType, value: object) -> bool | int | float:
    """The value as its cell takes it.

    Raises
    ------
    TypeError
        If it is of another kind.
    ValueError
        If it is out of range, or no value of a closed enum.
    """
    match type_:
        case Bool():
            return bool(index(cast("SupportsIndex", value)))
        case Int(bits, signed, _):
            return _ranged(_integer(value), bits, signed=signed)
        case Float():
            return _real(value)
        case Enum():
            return _enumerator(type_, value)
        case _:
            assert_never(type_)


def _integer(value: object) -> int:
    if isinstance(value, bool | np.bool_):
        raise TypeError("Expected an int, got a boolean.")
    return index(cast("SupportsIndex", value))


def _ranged(value: int, bits: int, *, signed: bool) -> int:
    low = -1 << bits - 1 if signed else 0
    if not low <= value < low + (1 << bits):
        raise ValueError(f"Value out of range: {value}")
    return value


def _real(value: object) -> float:
    if isinstance(value, str | bytes | bytearray):
        raise TypeError(f"must be real number, not {type(value).__name__}")
    return float(cast("SupportsFloat | SupportsIndex", value))


def _enumerator(type_: Enum, value: object) -> int:
    if isinstance(value, str):
        numbers = [number for name, number in type_.values if name == value]
        if not numbers:
            raise ValueError(f'unknown enum label "{value}"')
        return numbers[0]
    number = _ranged(_integer(value), 32, signed=True)
    if type_.closed and all(number != each for _, each in type_.values):
        raise ValueError(f"invalid enumerator {number}")
    return number


def text(type_: String, value: object) -> bytes:
    """The bytes of a string; those of a string of octets are kept as they are."""
    match value:
        case str() if type_.encoding == "utf-16":
            data = value.encode(UTF_16, "surrogatepass")
        case str():
            data = value.encode("utf-8", "surrogateescape" if type_.encoding == "octets" else "strict")
        case bytes() if type_.encoding != "utf-16":
            if type_.encoding == "utf-8":
                value.decode("utf-8")
            data = value
        case _:
            raise TypeError(f"expected str, {type(value).__name__} found")
    if type_.encoding == "utf-16":
        counted(len(data) // 2, None, type_.maximum, "code units")
    else:
        counted(len(data), None, type_.maximum, "bytes")
    return data


def decoded(type_: String, data: memoryview) -> str:
    """The text of a string's bytes. Octets that are no UTF-8 become lone surrogates, from which they can be written again."""
    match type_.encoding:
        case "utf-16":
            return str(data, UTF_16, "surrogatepass")
        case "octets":
            return str(data, "utf-8", "surrogateescape")
        case "utf-8":
            return str(data, "utf-8")


def counted(count: int, length: int | None, maximum: int | None, what: str = "elements") -> None:
    """Check a number of elements.

    Raises
    ------
    ValueError
        If it is not the length that the type fixes, or more than it allows.
    """
    if length is not None and count != length:
        raise ValueError(f"{count} {what} where the type has {length}")
    if maximum is not None and count > maximum:
        raise ValueError(f"{count} {what} where the type allows {maximum}")


def blob(value: object) -> memoryview:
    """Bytes of any contiguous buffer; a numpy image is one."""
    if isinstance(value, np.ndarray):
        flat: Any = np.ascontiguousarray(cast("Any", value)).reshape(-1)
        return memoryview(flat).cast("B")
    if isinstance(value, bytes | bytearray | memoryview):
        return memoryview(cast("bytes", value)).cast("B")
    raise TypeError(f"expected bytes, {type(value).__name__} found")


def numbers(type_: ScalarType, values: Iterable[Any]) -> np.ndarray[Any, Any]:
    """The elements of an array of scalars, as a flat array of their type.

    Raises
    ------
    TypeError, ValueError
        As `scalar` does for the first element that is wrong.
    """
    dtype = dtype_of(scalar_of(type_))
    if isinstance(values, np.ndarray):
        array = cast("np.ndarray[Any, Any]", values)
        if array.ndim != 1:
            raise ValueError(f"an array of {array.ndim} dimensions where one of 1 is expected")
        if _fits(type_, array, dtype):
            return array.astype(dtype, copy=False)
        values = array.tolist()
    elif isinstance(values, str | bytes):
        raise TypeError(f"expected an array of numbers, {type(values).__name__} found")
    with np.errstate(over="ignore"):
        return np.array([scalar(type_, each) for each in values], dtype)


def _fits(type_: ScalarType, array: np.ndarray[Any, Any], dtype: np.dtype[Any]) -> bool:
    """Whether every value of an array is one of the type, seen from its dtype alone or at the price of one pass."""
    if isinstance(type_, Enum) and type_.closed:
        return False
    if isinstance(type_, Float):
        return array.dtype.kind == "f" and array.dtype.itemsize <= dtype.itemsize
    return array.dtype == dtype
