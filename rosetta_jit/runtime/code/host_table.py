"""The table through which loaded code calls functions of this process: addresses of C functions, filled in when the code is loaded.

    int32 function(int64 *result, int64 number …, (uint8 *bytes, int64 size) …)      1 if there is a result

Any thread may call, with the interpreter lock or without it. An exception that gets here is printed by ctypes, and the function gives 0.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import Any

SHAPES = {
    "image.measure": (1, 1, False),
    "image.decompress": (0, 1, True),
    "image.compressed": (5, 1, False),
    "image.compress": (5, 1, True),
}
"""Of each function: how many numbers it takes, how much memory it reads, and whether it fills some."""


def fill(table: int, names: Sequence[str], functions: Mapping[str, Callable[..., int]]) -> list[object]:
    """Write the addresses of functions into the table at an address, in the order of their names; what is returned must live as long."""
    made = [_c_function(functions[name], *SHAPES[name]) for name in names]
    slots = (ctypes.c_void_p * len(names)).from_address(table)
    for number, function in enumerate(made):
        slots[number] = ctypes.cast(function, ctypes.c_void_p).value
    return made


def _c_function(function: Callable[..., int], numbers: int, read: int, fills: bool) -> Any:
    extents = read + fills
    passed = [ctypes.c_int64] * numbers + [ctypes.c_void_p, ctypes.c_int64] * extents
    prototype: Any = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.POINTER(ctypes.c_int64), *passed)

    def call(result: Any, *arguments: Any) -> int:
        spans = arguments[numbers:]
        memory = [_memory(spans[at], spans[at + 1], writable=at == 2 * read) for at in range(0, 2 * extents, 2)]
        result[0] = function(*arguments[:numbers], *memory)
        return 1

    return prototype(call)


def _memory(address: int | None, size: int, *, writable: bool) -> memoryview:
    """Bytes at an address; without any, the address may be none."""
    if not address or not size:
        return memoryview(bytearray())
    view = memoryview((ctypes.c_uint8 * size).from_address(address)).cast("B")
    return view if writable else view.toreadonly()
