"""The bytes of lanes as numbers: single cells, and whole arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]

SCALARS: tuple[str, ...] = ("bool", "i8", "u8", "i16", "u16", "i32", "u32", "i64", "u64", "f32", "f64")
_FORMATS = {
    "bool": "?",
    "i8": "b",
    "u8": "B",
    "i16": "h",
    "u16": "H",
    "i32": "i",
    "u32": "I",
    "i64": "q",
    "u64": "Q",
    "f32": "f",
    "f64": "d",
}
"""Of memoryview and numpy alike."""

BYTES = np.dtype(np.uint8)
"""What a lane is shown as that has no numbers of one type."""


def cell_key(lane: int, scalar: str) -> int:
    """The key of a lane's cells of one scalar in `Cells`."""
    return lane << 4 | SCALARS.index(scalar)


def dtype_of(scalar: str) -> np.dtype[Any]:
    """The numpy type of a scalar."""
    return np.dtype(_FORMATS[scalar])


class Memory(dict[int, memoryview]):
    """The bytes of each lane: in the first memory of all, until it moves to one of its own."""

    __slots__ = ("first", "offsets", "sizes")

    def __init__(self, first: memoryview, offsets: tuple[int, ...], sizes: tuple[int, ...]) -> None:
        self.first = first
        self.offsets = offsets
        self.sizes = sizes

    def __missing__(self, lane: int) -> memoryview:
        start = self.offsets[lane]
        return self.setdefault(lane, self.first[start : start + self.sizes[lane]])  # unless it has moved since, in another thread


class Cells(dict[int, Any]):
    """The lanes as cells of each scalar, made when first asked for: reading one costs a third of what numpy takes.

    They show where the lanes lie now. When one moves there are new `Cells`, and new `Arrays`: a thread may be making an entry of these.
    """

    __slots__ = ("memory",)

    def __init__(self, memory: Memory) -> None:
        self.memory = memory

    def __missing__(self, key: int) -> Any:
        lane: Any = self.memory[key >> 4]
        cells = self[key] = lane.cast(_FORMATS[SCALARS[key & 15]])
        return cells


class Arrays(dict[int, Array]):
    """The lanes of numbers as arrays of their type, all rows, made when first asked for."""

    __slots__ = ("array_type", "dtypes", "memory")

    def __init__(self, memory: Memory, dtypes: tuple[np.dtype[Any], ...], array_type: type[Array]) -> None:
        self.memory = memory
        self.dtypes = dtypes
        self.array_type = array_type

    def __missing__(self, lane: int) -> Array:
        array: Array = np.frombuffer(self.memory[lane], self.dtypes[lane]).view(self.array_type)
        self[lane] = array
        return array
