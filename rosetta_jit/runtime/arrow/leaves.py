"""Arrow arrays without nulls as the numbers and bytes of lanes: exactly, or `ValuesError`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, assert_never

import numpy as np
import pyarrow as pa
from pyarrow import types

from rosetta_jit.errors import ValuesError
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Enum, Float, Int, String
from rosetta_jit.runtime.arrow.plain import is_text, pairs
from rosetta_jit.runtime.cells import dtype_of
from rosetta_jit.runtime.holder.coerce import UTF_16
from rosetta_jit.runtime.holder.record import ScalarType
from rosetta_jit.runtime.rows import offsets

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.runtime.rows import Indices


def refused(wanted: str, array: pa.Array, path: str) -> ValuesError:
    """The error of a column of another type."""
    return ValuesError(path, f"expected {wanted}, found a column of {array.type}")


def solid(array: pa.Array, path: str) -> pa.Array:
    """The array, in which nothing is null; raises ValuesError where something is."""
    if array.null_count:
        number = int(np.argmin(array.is_valid().to_numpy(zero_copy_only=False)))
        raise ValuesError(path, f"value {number} is null, and the field cannot be absent")
    return array


def numbers_of(type_: ScalarType, array: pa.Array, path: str, *, has_gaps: bool) -> NDArray[Any]:
    """Numbers as their cells take them; ``has_gaps`` as of `sources.Columns`."""
    array = solid(_without_gaps(type_, array, path) if has_gaps and types.is_floating(array.type) else array, path)
    match type_:
        case _ if types.is_null(array.type):
            return np.empty(0, dtype_of(scalar_of(type_)))  # of no type, for there are none
        case Bool() if types.is_boolean(array.type):
            return _numpy(array)
        case Int() if types.is_integer(array.type):
            return _cast(array, dtype_of(scalar_of(type_)), path)
        case Float() if types.is_floating(array.type) or types.is_integer(array.type):
            return _rounded(array, dtype_of(scalar_of(type_)), path)
        case Enum() if types.is_integer(array.type):
            return _enumerators(type_, _cast(array, np.dtype(np.int32), path), path)
        case Enum() if _is_text(array):
            return _named(type_, array, path)
        case Bool() | Int() | Float() | Enum():
            raise refused(_WANTED[type(type_)], array, path)
        case _:
            assert_never(type_)


def _without_gaps(type_: ScalarType, array: pa.Array, path: str) -> pa.Array:
    """Floats of pandas: NaN where one is null, or the integers that they stand for."""
    match type_:
        case Float():
            return array.fill_null(float("nan")) if array.null_count else array
        case Int():
            try:
                return array.cast(pa.from_numpy_dtype(dtype_of(scalar_of(type_))))
            except pa.ArrowInvalid as error:
                raise ValuesError(path, f"a value is no integer, or out of range: {error}") from None
        case Bool() | Enum():
            return array
        case _:
            assert_never(type_)


_WANTED = {Bool: "booleans", Int: "integers", Float: "numbers", Enum: "names or integers"}


def _numpy(array: pa.Array) -> NDArray[Any]:
    return array.to_numpy(zero_copy_only=False)


def _cast(array: pa.Array, dtype: np.dtype[Any], path: str) -> NDArray[Any]:
    try:
        return _numpy(array.cast(pa.from_numpy_dtype(dtype)))
    except pa.ArrowInvalid as error:
        raise ValuesError(path, f"a value is out of range: {error}") from None


def _rounded(array: pa.Array, dtype: np.dtype[Any], path: str) -> NDArray[Any]:
    """Floats that are what they were."""
    floats = _numpy(array)
    with np.errstate(over="ignore"):
        values = floats.astype(dtype)
        same = values.astype(floats.dtype) == floats
    wrong = np.flatnonzero(~same & ~np.isnan(values))
    if len(wrong):
        raise ValuesError(path, f"value {wrong[0]}, {floats[wrong[0]]}, is none of {dtype}; cast the column to round it")
    return values


def _enumerators(type_: Enum, numbers: NDArray[Any], path: str) -> NDArray[Any]:
    known = [number for _, number in type_.values]
    if type_.closed and not np.isin(numbers, known).all():
        raise ValuesError(path, f"invalid enumerator {numbers[~np.isin(numbers, known)][0]}")
    return numbers


def _named(type_: Enum, array: pa.Array, path: str) -> NDArray[Any]:
    """The numbers of names; those of an open enum may be digits, as `to_arrow` writes numbers without a name."""
    encoded = array if types.is_dictionary(array.type) else array.dictionary_encode()
    assert isinstance(encoded, pa.DictionaryArray)
    codes = _numpy(solid(encoded.indices, path))
    numbers = dict(type_.values)
    found = np.array([_number(type_, numbers, name, path) for name in encoded.dictionary.to_pylist()], np.int32)
    return found[codes] if len(found) else np.zeros(0, np.int32)


def _number(type_: Enum, numbers: dict[str, int], name: str, path: str) -> int:
    if name in numbers:
        return numbers[name]
    if not type_.closed and name.removeprefix("-").isdecimal() and -(2**31) <= int(name) < 2**31:
        return int(name)
    raise ValuesError(path, f'unknown enum label "{name}"')


def _is_text(array: pa.Array) -> bool:
    return is_text(array.type.value_type if types.is_dictionary(array.type) else array.type)


def text_of(type_: String, array: pa.Array, path: str) -> tuple[NDArray[Any], Indices]:
    """The bytes or code units of texts, one behind the other, and how many each has."""
    if _is_text(array):
        data, counts = _content(array.cast(pa.large_string()), path)
        return (data, counts) if type_.encoding != "utf-16" else _as_utf16(data, counts)
    if type_.encoding == "octets":
        return blob_of(array, path)
    raise refused("texts", array, path)


def blob_of(array: pa.Array, path: str) -> tuple[NDArray[np.uint8], Indices]:
    """The content of bytes fields, one behind the other, and how many bytes each has."""
    type_ = array.type
    if not (types.is_binary(type_) or types.is_large_binary(type_) or types.is_fixed_size_binary(type_)):
        raise refused("bytes", array, path)
    return _content(array.cast(pa.large_binary()), path)


def _content(array: pa.Array, path: str) -> tuple[NDArray[np.uint8], Indices]:
    solid(array, path)
    _, places, data = array.buffers()
    if not len(array) or places is None:
        return np.empty(0, np.uint8), np.zeros(len(array), np.int64)
    ends = np.frombuffer(memoryview(places), np.int64)[array.offset : array.offset + len(array) + 1]
    octets = np.empty(0, np.uint8) if data is None or not data.size else np.frombuffer(memoryview(data), np.uint8)
    return octets[int(ends[0]) : int(ends[-1])], np.diff(ends)


def _as_utf16(octets: NDArray[np.uint8], counts: Indices) -> tuple[NDArray[np.uint16], Indices]:
    """UTF-8 as code units. The first byte of a character stands for one, of one of four bytes for two."""
    units = np.frombuffer(octets.tobytes().decode().encode(UTF_16), np.uint16)
    sizes = ((octets & 0xC0) != 0x80).astype(np.int64) + (octets >= 0xF0)
    return units, np.diff(offsets(sizes)[offsets(counts)])


def listed_of(array: pa.Array, path: str) -> tuple[pa.Array, Indices]:
    """The elements of lists, or the entries of maps, and how many each has."""
    if types.is_map(array.type):
        array = pairs(array)
    if types.is_fixed_size_list(array.type):
        counts = np.full(len(array), array.type.list_size, np.int64)
    elif types.is_list(array.type) or types.is_large_list(array.type):
        counts = np.asarray(_numpy(array.value_lengths()), np.int64)
    else:
        raise refused("lists", array, path)
    return array.flatten(), counts
