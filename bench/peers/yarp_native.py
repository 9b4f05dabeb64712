"""The native peers of bottles and images: real YARP or the model of it, and decoders written by hand in C++.

These are compiled with `-O2`, as packages of distributions are, and once more for this machine, with `-O3 -march=native`.
"""

from __future__ import annotations

import ctypes
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.peers.native import FOLDER

if TYPE_CHECKING:
    from collections.abc import Callable

LIBRARY, FOR_THIS_MACHINE = FOLDER / "libpeers.so", FOLDER / "libpeers_here.so"


class Peers:
    """Most methods give a function from iterations to nanoseconds a message; it keeps the arrays that it fills."""

    def __init__(self) -> None:
        self.library = ctypes.CDLL(str(LIBRARY))
        self.library.dynamic_decoder.restype = ctypes.c_char_p
        self.here = ctypes.CDLL(str(FOR_THIS_MACHINE))

    @property
    def dynamic_decoder(self) -> str:
        """Which dynamic decoder was linked: real YARP, or the model of it."""
        return self.library.dynamic_decoder().decode()

    def dynamic(self, message: bytes) -> Callable[[int], float]:
        return self._timed("dynamic_decode_ns", message)

    def dynamic_values(self, message: bytes) -> np.ndarray:
        """The numbers that the dynamic decoder reads."""
        values = np.zeros(len(message) // 8)
        function = self.library.dynamic_values
        function.restype = ctypes.c_int64
        count = function(message, ctypes.c_int64(len(message)), values.ctypes, ctypes.c_int64(len(values)))
        return values[: max(count, 0)]

    def yarp(self, class_: str, message: bytes) -> Callable[[int], float] | None:
        """YARP's ``image`` or ``vector``, if real YARP was linked."""
        name = f"yarp_{class_}_ns"
        return self._timed(name, message) if hasattr(self.library, name) else None

    def loop(self, message: bytes, tag: int, angles: np.ndarray, *, here: bool = False) -> Callable[[int], float]:
        return self._timed("loop_decode_ns", message, tag, angles.ctypes, here=here)

    def tagged_loop(self, message: bytes, tag: int, angles: np.ndarray, *, here: bool = False) -> Callable[[int], float]:
        return self._timed("tagged_decode_ns", message, tag, angles.ctypes, here=here)

    def copy(self, message: bytes, tag: int, degrees: np.ndarray) -> Callable[[int], float]:
        return self._timed("copy_decode_ns", message, tag, degrees.ctypes)

    def image(self, job: str, message: bytes, pixels: np.ndarray, *, here: bool = False) -> Callable[[int], float]:
        """``job``: ``unpad``, ``swap`` or ``planar``."""
        return self._timed(f"image_{job}_ns", message, pixels.ctypes, here=here)

    def memmove(self, size: int) -> Callable[[int], float]:
        function = self._function("memmove_ns")
        target, source = ctypes.create_string_buffer(size), ctypes.create_string_buffer(size)
        return lambda iterations: function(target, source, ctypes.c_int64(size), ctypes.c_int64(iterations))

    def _timed(self, name: str, message: bytes, *arguments: Any, here: bool = False) -> Callable[[int], float]:
        """``here`` is for what is compiled for this machine."""
        return partial(nanoseconds, self._function(name, here=here), (message, ctypes.c_int64(len(message)), *arguments))

    def _function(self, name: str, *, here: bool = False) -> Any:
        function = (self.here if here else self.library)[name]
        function.restype = ctypes.c_double
        return function


def nanoseconds(function: Any, arguments: tuple[Any, ...], iterations: int) -> float:
    """What a timed loop gives; ValueError if it refuses the message."""
    took = function(*arguments, ctypes.c_int64(iterations))
    if took < 0:
        raise ValueError(f"{function.__name__} refuses the message")
    return took


def empty_builtin() -> Any:
    """A built-in function of one argument that gives it back: what any call from Python into compiled code costs at the least."""
    library = ctypes.CDLL(str(LIBRARY))
    library.empty_method.restype = ctypes.c_void_p
    make = ctypes.pythonapi.PyCFunction_NewEx
    make.restype, make.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
    return make(library.empty_method(), None, None)
