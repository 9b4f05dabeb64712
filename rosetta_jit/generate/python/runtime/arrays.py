"""Arrays of numbers that are numpy's."""

# pyright: reportUnusedFunction=false, reportUnusedClass=false, reportUnknownArgumentType=false

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
import numpy.typing as npt

_Array = np.ndarray
_numbers_in = np.frombuffer
_numbers_of = np.array
_PLAIN = frozenset(map(np.dtype, "?bBhHiIlLqQfd"))
"""The types of arrays of numbers as this machine has them."""


class _Comparable:
    """Objects are equal if their attributes are; arrays are if their elements are."""

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        if self.__class__ is not other.__class__:
            return NotImplemented
        names: tuple[str, ...] = getattr(self, "__match_args__", ())
        return all(_are_same(getattr(self, name), getattr(other, name)) for name in names)

    def __hash__(self) -> int:
        raise TypeError(f"unhashable type: {type(self).__name__!r}")


def _are_same(left: Any, right: Any) -> bool:
    if type(left) is np.ndarray or type(right) is np.ndarray:
        return np.array_equal(left, right)
    if type(left) is list and type(right) is list:
        return len(left) == len(right) and all(map(_are_same, left, right))
    return bool(left == right)


_copied = np.ndarray.copy


def _as_it_is(numbers: Any) -> Any:
    """A view of bytes, that cannot be written to."""
    return numbers


def _few(numbers: Any) -> Any:
    """Few numbers as Python's, which are packed together with those around them."""
    if type(numbers) is not _Array:
        return numbers
    return numbers.tolist() if numbers.dtype in _PLAIN or numbers.dtype.kind not in "mM" else numbers


def _integers(dtype: np.dtype[Any], numbers: Any) -> Any:
    """The integers of an array as Python's; raises `ValueError` where they are none that the field can have."""
    if type(numbers) is not _Array:
        return array(dtype.char, numbers).tolist()
    return numbers.tolist() if numbers.dtype is dtype and numbers.ndim == 1 else np.frombuffer(_raw(dtype, numbers), dtype).tolist()


def _raw(dtype: np.dtype[Any], numbers: Any, is_bool: bool = False) -> bytes:
    """The bytes of numbers; raises `ValueError` where they are not of one dimension, or cannot be what the field has."""
    if type(numbers) is _Array and numbers.ndim == 1:
        if numbers.dtype is dtype:
            return numbers.tobytes()
        if numbers.dtype.type is (np.bool_ if is_bool else dtype.type):
            return numbers.astype(dtype).tobytes()
    found: npt.NDArray[Any] = np.asarray(numbers, np.bool_ if is_bool else None)
    if found.ndim != 1:
        raise ValueError(f"an array of {found.ndim} dimensions in place of one")
    if not found.size or np.can_cast(found.dtype, dtype):
        return found.astype(dtype, copy=False).tobytes()
    if found.dtype.kind not in ("biuf" if dtype.kind == "f" else "biu"):
        raise ValueError(f"an array of {found.dtype} in place of {dtype.type.__name__}")
    with np.errstate(over="ignore"):
        converted = found.astype(dtype)
    fit = np.isinf(converted) == np.isinf(found) if dtype.kind == "f" else converted == found
    if not fit.all():
        raise ValueError(f"a number that does not fit {dtype.type.__name__}")
    return converted.tobytes()


def _table(dtype: np.dtype[Any], rows: Any, shape: tuple[int, ...], is_bool: bool = False) -> bytes | None:
    """The bytes of arrays in arrays, of a shape; nothing where they have another one, or numbers of another type."""
    try:
        found: npt.NDArray[Any] = np.asarray(rows if isinstance(rows, list | _Array) else [*rows])
    except (AttributeError, TypeError, ValueError):
        return None
    if found.shape != shape or found.dtype.type is not (np.bool_ if is_bool else dtype.type):
        return None
    return found.astype(dtype, copy=False).tobytes()
