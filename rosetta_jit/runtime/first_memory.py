"""Writing the first memory of a holder's lanes: what its plan prescribes, at an aligned place, and the address of each lane."""

from __future__ import annotations

import ctypes

import numpy as np

from rosetta_jit.runtime.attributes.code import functions, is_compiled
from rosetta_jit.runtime.memory import ALIGNMENT


def begun(arena: bytearray, begin: bytes, places: bytes) -> int:
    """Copy how the first memory of lanes begins to where it is aligned, and write where each lane lies; where the state does.

    Compiled code does it if there is some.
    """
    return functions()["begin"](arena, begin, places) if is_compiled("begin") else _begun_in_python(arena, begin, places)


def _begun_in_python(arena: bytearray, begin: bytes, places: bytes) -> int:
    address = address_of_bytes(arena)
    shift = -address % ALIGNMENT
    arena[shift : shift + len(begin)] = begin
    words = memoryview(arena)[shift:][: len(arena) - shift & -8].cast("q")
    pairs = np.frombuffer(places, np.int64).reshape(-1, 2)
    for word, offset in zip(pairs[:, 0].tolist(), pairs[:, 1].tolist(), strict=True):
        words[word] = address + shift + offset
    return address + shift


def address_of_bytes(arena: bytearray) -> int:
    """The address of bytes of ours."""
    return ctypes.addressof(ctypes.c_char.from_buffer(arena))
