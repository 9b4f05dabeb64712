"""The native peers of `bench/native`, through ctypes; they time their own loops, so that ctypes costs nothing."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

ROUNDS = 7
WARM_UP = 1000


class Peers:
    """Each method gives the best nanoseconds a message of a few rounds."""

    def __init__(self, library: Path) -> None:
        self._library = ctypes.CDLL(str(library))
        self._library.dynamic_decoder.restype = ctypes.c_char_p
        for name in ("dynamic_decode_ns", "loop_decode_ns", "copy_decode_ns", "memmove_ns"):
            getattr(self._library, name).restype = ctypes.c_double

    @property
    def dynamic_decoder(self) -> str:
        """Which dynamic decoder was linked: real YARP, or the model of it."""
        return self._library.dynamic_decoder().decode()

    def dynamic_decode_ns(self, message: bytes, iterations: int = 100_000) -> float:
        return self._best("dynamic_decode_ns", iterations, message, ctypes.c_int64(len(message)))

    def loop_decode_ns(self, message: bytes, tag: int, iterations: int = 500_000) -> float:
        angles = (ctypes.c_float * (len(message) // 8))()
        return self._best("loop_decode_ns", iterations, message, ctypes.c_int64(len(message)), tag, angles)

    def copy_decode_ns(self, message: bytes, tag: int, iterations: int = 500_000) -> float:
        angles = (ctypes.c_double * (len(message) // 8))()
        return self._best("copy_decode_ns", iterations, message, ctypes.c_int64(len(message)), tag, angles)

    def _best(self, name: str, iterations: int, *arguments: object) -> float:
        function = getattr(self._library, name)
        if function(*arguments, ctypes.c_int64(WARM_UP)) < 0:
            raise ValueError(f"{name} refuses the message")
        return min(function(*arguments, ctypes.c_int64(iterations)) for _ in range(ROUNDS))
