"""Strings of lanes as Arrow's: UTF-8, which Arrow's readers take on trust, so that all of it is checked here."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from rosetta_jit.model.types import String
from rosetta_jit.runtime.holder.coerce import UTF_16
from rosetta_jit.runtime.rows import offsets

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.runtime.rows import Indices


class NoTextError(ValueError):
    """A string that UTF-8 cannot carry, and its number; never leaves the package."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def text_array(type_: String, data: NDArray[Any], places: Indices, validity: pa.Buffer | None) -> pa.Array:
    """Strings of a type, whose bytes or code units lie one behind the other; raises NoTextError where one is no text."""
    codec = UTF_16 if type_.encoding == "utf-16" else "utf-8"
    try:
        octets, ends = _as_utf8(data, places) if codec == UTF_16 else (data, places)
        array = pa.Array.from_buffers(pa.large_string(), len(ends) - 1, [validity, pa.py_buffer(ends), pa.py_buffer(octets)])
        if octets.size and octets.max() >= 0x80:
            array.validate(full=True)
    except (UnicodeDecodeError, pa.ArrowInvalid):
        raise NoTextError(_first_wrong(data, places, codec)) from None
    return array


def _as_utf8(units: NDArray[np.uint16], places: Indices) -> tuple[NDArray[np.uint8], Indices]:
    """Code units as UTF-8, all at once. Each half of a surrogate pair stands for two of its four bytes."""
    octets = np.frombuffer(units.tobytes().decode(UTF_16).encode(), np.uint8)
    is_surrogate = (units & 0xF800) == 0xD800
    sizes = 1 + (units >= 0x80).astype(np.int64) + ((units >= 0x800) & ~is_surrogate)
    return octets, offsets(sizes)[places]


def _first_wrong(data: NDArray[Any], places: Indices, codec: str) -> int:
    for number in range(len(places) - 1):
        try:
            str(data[places[number] : places[number + 1]].tobytes(), codec)
        except UnicodeDecodeError:
            return number
    raise AssertionError("all strings are texts, though Arrow says that one is none")
