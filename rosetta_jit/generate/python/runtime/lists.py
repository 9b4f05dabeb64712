"""Lists of numbers, which the struct module and arrays pack."""

# pyright: reportUnusedFunction=false, reportUnusedClass=false, reportUnknownArgumentType=false

from __future__ import annotations

from array import array
from collections.abc import Callable
from struct import Struct
from struct import iter_unpack as _unpack_each
from struct import pack as _pack
from struct import unpack_from as _unpack_from
from typing import Any

_q = "n" if Struct("n").size == 8 else "q"
_Q = _q.upper()
"""Integers of 64 bits for the struct module, which packs large ones of C's type ssize_t in a third of the time where that has as many."""


def _packed(code: str, numbers: Any) -> bytes:
    """The bytes of numbers as they lie in memory."""
    if isinstance(numbers, array) and numbers.typecode == code:
        return numbers.tobytes()
    return _pack(f"={len(numbers)}{code}", *numbers)


def _turned(part: Any, code: str) -> bytes:
    """Numbers with the order of their bytes turned around."""
    numbers: array[Any] = array(code)
    numbers.frombytes(part)
    numbers.byteswap()
    return numbers.tobytes()


def _many(part: memoryview, code: str) -> list[Any]:
    """The numbers that lie in a part of a message."""
    numbers: array[Any] = array(code)
    numbers.frombytes(part)
    return numbers.tolist()


def _many_turned(part: memoryview, code: str) -> list[Any]:
    """The same where the high byte of each comes first."""
    numbers: array[Any] = array(code)
    numbers.frombytes(part)
    numbers.byteswap()
    return numbers.tolist()


def _pieces(data: bytes, begin: int, size: int, count: int) -> list[bytes]:
    """Bytes of one size, which lie one behind the other in a message."""
    if count < 160:
        return [*_unpack_from(f"{size}s" * count, data, begin)]
    return [each for (each,) in _unpack_each(f"{size}s", data[begin : begin + count * size])]


def _fitting(code: str, numbers: Any) -> Any:
    """Integers that all fit their field, of which the struct module has the code."""
    _pack(f"={len(numbers)}{code}", *numbers)
    return numbers


_KEPT = 128


class _ByCount(dict[int, Any]):
    """What reads or writes so many numbers of one type by one call, by their count: the struct module makes it where it is not kept."""

    def __init__(self, code: Callable[[int], str], method: str) -> None:
        super().__init__()
        self.code, self.method = code, method

    def __missing__(self, count: int) -> Any:
        if len(self) >= _KEPT:
            self.clear()
        found = self[count] = getattr(Struct(self.code(count)), self.method)
        return found
