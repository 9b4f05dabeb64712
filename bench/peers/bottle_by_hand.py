"""What a person writes in Python for the bottle that is measured: numba on arrays, numpy, struct. Only numba's checks the header."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

HEADER = 8
DEGREE = np.float32(np.pi / 180)


def numba_by_hand() -> Any:
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


def numba_kernel(decoder: Any, message: bytes) -> tuple[Any, Any]:
    """Our kernel, called through numba's dispatcher instead of our entry; and the state of a holder that is large enough."""
    import numba

    from rosetta_jit.backends.numba import data_pointer

    kernel = decoder.kernel

    @numba.njit
    def decode(message: Any, state: Any) -> int:
        return kernel(data_pointer(message), 0, message.size, data_pointer(state), 0)

    return decode, decoder.into(message, decoder.new()).lanes_.state


def frombuffer(message: bytes) -> Any:
    """A view of the degrees."""
    return np.frombuffer(message, np.float64, offset=HEADER)


def frombuffer_radians(message: bytes) -> Any:
    """The angles, as our decoder gives them, anew."""
    return np.radians(np.frombuffer(message, np.float64, offset=HEADER)).astype(np.float32)


def struct_unpack(count: int) -> Callable[[bytes], tuple[float, ...]]:
    """A tuple of degrees."""
    unpack_from = struct.Struct(f"<{count}d").unpack_from
    return lambda message: unpack_from(message, HEADER)


def struct_tagged(count: int) -> Callable[[bytes], tuple[float, ...]]:
    """A tuple of tags and degrees."""
    unpack_from = struct.Struct("<" + count * "id").unpack_from
    return lambda message: unpack_from(message, HEADER)
