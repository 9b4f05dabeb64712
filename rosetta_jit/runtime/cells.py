"""The bytes of lanes as numbers: single cells, and whole arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

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


class Cells(dict[int, Any]):
    """The lanes as cells of each scalar, made when first asked for: reading one costs a third of what numpy takes."""

    __slots__ = ("buffers",)

    def __init__(self, buffers: list[NDArray[np.uint8]]) -> None:
        self.buffers = buffers

    def __missing__(self, key: int) -> Any:
        lane: Any = memoryview(cast("Any", self.buffers[key >> 4]))
        cells: Any = lane.cast(_FORMATS[SCALARS[key & 15]])
        self[key] = cells
        return cells


class Arrays(dict[int, Array]):
    """The lanes of numbers as arrays of their type, all rows, made when first asked for."""

    __slots__ = ("array_type", "buffers", "dtypes")

    def __init__(self, buffers: list[NDArray[np.uint8]], dtypes: tuple[np.dtype[Any], ...], array_type: type[Array]) -> None:
        self.buffers = buffers
        self.dtypes = dtypes
        self.array_type = array_type

    def __missing__(self, lane: int) -> Array:
        array: Array = self.buffers[lane].view(self.dtypes[lane]).view(self.array_type)
        self[lane] = array
        return array
