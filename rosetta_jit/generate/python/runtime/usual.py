"""What generated modules have in common: it becomes part of each of them, so that a module needs the standard library alone."""
# ruff: noqa: F401, N812, N818 - the classes use what this part does not; what ends an attempt is no error
# pyright: reportUnusedImport=false, reportUnusedFunction=false, reportUnknownVariableType=false, reportUnknownMemberType=false
# pyright: reportUnknownArgumentType=false

import math
from array import array
from collections.abc import Callable
from ctypes import c_float
from dataclasses import dataclass, field
from itertools import count as _count
from operator import index as _index
from struct import Struct
from struct import error as _StructError
from struct import iter_unpack as _unpack_each
from struct import pack as _pack
from struct import unpack_from as _unpack
from time import time_ns as _time_ns
from typing import Any

now: Callable[[], int] = _time_ns
"""What `now()` says in the mapping: ns since 1970."""

functions: dict[str, Callable[..., Any]] = {}
"""The functions that the mapping declares, which you give by name. One that raises `Refused` refuses the message."""


class Refused(Exception):
    """A function of yours does not accept its arguments."""


class MessageError(ValueError):
    """What is wrong with a message: its kind, the field (``.joints[3].name``), one sentence, the mapping's line."""

    def __init__(self, kind: str, path: str, detail: str, line: str = "", offset: int | None = None) -> None:
        self.kind, self.path, self.detail, self.line, self.offset = kind, path, detail, line, offset
        where = f" at {path}" if path else ""
        byte = "" if offset is None else f", byte {offset}"
        super().__init__(f"{kind}{where}{byte}: {detail}" + (f" ({line})" if line else ""))


class DecodeError(MessageError):
    """A message that cannot be read; ``offset`` is that of the byte."""


class EncodeError(MessageError):
    """An object that cannot be written."""


class _Failed(Exception):
    """An attempt to read or write has come upon something that cannot be."""

    def __init__(self, site: int, at: int, indices: tuple[Any, ...] = (), detail: bytes | None = None) -> None:
        self.site, self.at, self.indices, self.detail = site, at, indices, detail


def _error(sites: tuple[tuple[Any, ...], ...], failed: _Failed, end: int | None) -> MessageError:
    """The error of a failure; ``end`` is that of the message which was read."""
    kind, path, detail, line, parts = sites[failed.site]
    at, indices = failed.at, list(failed.indices)
    if failed.site == 0:
        path = "{}"
    for offset, size, step, inner in parts:
        available, element = (0 if end is None else end - at), 0
        if step and available - offset - size >= 0:
            element = (available - offset - size) // step + 1
        if step or offset + size > available:
            path, at = inner, at + offset + element * step
            count = inner.count("{}")
            if step and count:
                indices = [*indices, 0, 0, 0, 0][:count]
                indices[count - 1] = element
            break
    pieces = path.split("{}")
    path = pieces[0] + "".join(f"{number}{piece}" for number, piece in zip([*indices, 0, 0, 0, 0], pieces[1:], strict=False))
    if failed.detail is not None:
        detail = failed.detail.decode("utf-8", "replace")
    return EncodeError(kind, path, detail, line) if end is None else DecodeError(kind, path, detail, line, at)


_ZERO, _ZERO_FLOAT = 0, 0.0
"""What numbers are that nobody has set: the same objects as defaults, so that it takes no call to see that."""

_q, _Q = ("l", "L") if Struct("l").size == 8 else ("q", "Q")
"""Integers of 64 bits for the struct module, which packs those of C's type long in less time where they have as many."""

_NOTHING = bytearray()
"""Rows of lanes that have no room yet."""

_new = object.__new__
"""Makes an object that has no field yet: what makes it sets them all."""


def _more(lane: Any, room: int, missing: int, size: int, most: int, path: str) -> tuple[bytearray, int]:
    """A lane with room for more rows of ``size`` bytes; a message that asks for more than ``most`` takes a length from what it says."""
    wanted = room + missing
    if wanted > most:
        raise _Failed(0, 0, (path,))
    if room or missing == 1:
        wanted = max(wanted, min(most, 2 * room), min(most, 16))
    grown = bytearray(wanted * size)
    grown[: len(lane)] = lane
    return grown, wanted


def _packed(code: str, numbers: Any) -> bytes:
    """The bytes of numbers as they lie in memory."""
    if isinstance(numbers, array) and numbers.typecode == code:
        return numbers.tobytes()
    return _pack(f"={len(numbers)}{code}", *numbers)


def _turned(part: Any, code: str) -> bytes:
    """Numbers with the order of their bytes turned around."""
    numbers = array(code)
    numbers.frombytes(part)
    numbers.byteswap()
    return numbers.tobytes()


def _within(number: Any, least: int, most: int) -> int:
    """An integer that fits its field."""
    found = _index(number)
    if not least <= found <= most:
        raise ValueError(f"{found} is not between {least} and {most}")
    return found


def _many(part: Any, code: str) -> list[Any]:
    """The numbers that lie in a message."""
    return array(code, part).tolist()


def _many_turned(part: Any, code: str) -> list[Any]:
    """The same where the high byte of each comes first."""
    numbers = array(code, part)
    numbers.byteswap()
    return numbers.tolist()


def _text(lane: Any, data: Any, start: int, count: int) -> str:
    """A text: of a lane, or where the count is negative of the message."""
    if count < 0:
        return str(data[start : start - 1 - count], "utf-8", "surrogateescape")
    return str(lane[start : start + count], "utf-8", "surrogateescape")


def _texts(lane: Any, data: Any, spans: Any) -> list[str]:
    """The texts of an array: where all of a lane is ASCII they are parts of one text."""
    rows = zip(spans[::2], spans[1::2], strict=True)
    if not lane.isascii():
        return [_text(lane, data, start, count) for start, count in rows]
    whole = lane.decode()
    return [whole[start : start + count] if count >= 0 else _text(lane, data, start, count) for start, count in rows]


def _bytes(lane: Any, data: Any, start: int, count: int) -> bytes:
    return bytes(data[start : start - 1 - count]) if count < 0 else bytes(lane[start : start + count])


def _text16(lane: Any, start: int, count: int) -> str:
    return str(bytes(lane[2 * start : 2 * (start + count)]), "utf-16-le", "surrogatepass")


def _is_text(memory: Any, start: int, size: int) -> bool:
    try:
        str(memory[start : start + size], "utf-8")
    except UnicodeDecodeError:
        return False
    return True


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


_BITS64, _FLOAT64, _BITS32, _FLOAT32 = Struct("=Q"), Struct("=d"), Struct("=I"), Struct("=f")


def _bits64(number: float) -> int:
    return _BITS64.unpack(_FLOAT64.pack(number))[0]


def _float64(bits: int) -> float:
    return _FLOAT64.unpack(_BITS64.pack(bits))[0]


def _bits32(number: float) -> int:
    return _BITS32.unpack(_FLOAT32.pack(number))[0]


def _float32(bits: int) -> float:
    return _FLOAT32.unpack(_BITS32.pack(bits))[0]
