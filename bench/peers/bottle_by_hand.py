"""What a person writes in Python for the bottles that are measured: numba on arrays, numpy, struct. Only numba checks headers and tags."""

from __future__ import annotations

import struct
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

HEADER = 8
DEGREE = np.float32(np.pi / 180)
TAGGED = np.dtype([("tag", "<i4"), ("degrees", "<f8")])
"""An element with its tag before it."""


def numba_specialised() -> Any:
    """Header check and loop in numba, without any of ours: from an array of bytes into an array of angles."""
    import numba

    @numba.njit
    def decode(message: Any, angles: Any) -> int:
        if message.size < HEADER:
            return -1
        head = message[:HEADER].view(np.int32)
        if head[0] != 266 or message.size != HEADER + 8 * head[1] or angles.size != head[1]:
            return -1
        degrees = message[HEADER:].view(np.float64)
        for index in range(angles.size):
            angles[index] = np.float32(degrees[index]) * DEGREE
        return message.size

    return decode


def numba_many(count: int) -> Any:
    """Many messages of so many numbers in a loop: into an array of angles, a row each. How many were done."""
    import numba

    @numba.njit
    def decode(buffer: Any, offsets: Any, angles: Any) -> int:
        for row in range(offsets.size - 1):
            begin, end = offsets[row], offsets[row + 1]
            if begin < 0 or begin + HEADER > end or end > buffer.size:
                return row
            message = buffer[begin:end]
            head = message[:HEADER].view(np.int32)
            if head[0] != 266 or head[1] != count or message.size != HEADER + 8 * count:
                return row
            degrees = message[HEADER:].view(np.float64)
            for index in range(count):
                angles[row, index] = np.float32(degrees[index]) * DEGREE
        return offsets.size - 1

    return decode


def numba_tagged() -> Any:
    """The same with a tag before each number."""
    import numba

    @numba.njit
    def decode(message: Any, angles: Any) -> int:
        if message.size < HEADER:
            return -1
        head = message[:HEADER].view(np.int32)
        if head[0] != 256 or message.size != HEADER + 12 * head[1] or angles.size != head[1]:
            return -1
        elements = message[HEADER:].view(TAGGED)
        for index in range(angles.size):
            if elements[index].tag != 10:
                return -1
            angles[index] = np.float32(elements[index].degrees) * DEGREE
        return message.size

    return decode


def numba_kernel(decoder: Any, holder: Any) -> tuple[Any, Any]:
    """Our kernel in a function of numba's, called through its dispatcher instead of our entry; and the holder that it fills."""
    import numba

    kernel = decoder.kernel

    @numba.njit
    def decode(message: Any, holder: Any) -> None:
        kernel(message, holder)

    return decode, holder


def frombuffer(message: bytes) -> Callable[[bytes], np.ndarray]:
    """A view of the degrees."""
    if _is_tagged(message):
        return lambda message: np.frombuffer(message, TAGGED, offset=HEADER)["degrees"]
    return partial(np.frombuffer, dtype=np.float64, offset=HEADER)


def radians(message: bytes) -> Callable[[bytes], np.ndarray]:
    """The angles, as our decoder gives them, anew."""
    view = frombuffer(message)
    return lambda message: np.radians(view(message)).astype(np.float32)


def unpacked(message: bytes) -> Callable[[bytes, int], tuple[float, ...]]:
    """A tuple of degrees, with their tags if they have some."""
    return _format(message).unpack_from


def packed(message: bytes) -> tuple[Callable[..., bytes], tuple[float, ...]]:
    """The message out of numbers, and the numbers."""
    whole = struct.Struct(f"<ii{_format(message).format.lstrip('<')}")
    return whole.pack, whole.unpack(message)


def _format(message: bytes) -> struct.Struct:
    count = struct.unpack_from("<ii", message)[1]
    return struct.Struct("<" + ("id" * count if _is_tagged(message) else f"{count}d"))


def _is_tagged(message: bytes) -> bool:
    return struct.unpack_from("<i", message)[0] == 256
