"""The ways to run a kernel, all with one signature: buffer, begin, end, rows, row."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import TYPE_CHECKING

from rosetta_jit.backends.entry.link import compile_program
from rosetta_jit.backends.python.function import compile_python
from rosetta_jit.kernel import interpret
from rosetta_jit.kernel.entries import SYMBOLS
from rosetta_jit.runtime.code import native
from tests.backends.holders import KERNEL

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Kernel

ENGINES = ("interpreter", "python", "llvm", "numba")


@cache
def library(kernel: Kernel, *, with_numba: bool) -> native.Library:
    return native.load(compile_program([kernel], "decode", with_numba=with_numba), SYMBOLS["decode"])


@cache
def engine(name: str, kernel: Kernel):
    """``run(buffer, begin, end, rows, row)``; the buffer is a writable bytearray or an address."""
    if name == "interpreter":
        return lambda buffer, begin, end, rows, row: interpret.run(kernel, buffer, begin, end, rows.state, rows.lanes, row)
    if name == "python":
        function = compile_python(kernel)
        return lambda buffer, begin, end, rows, row: function(buffer, begin, end, rows.state, rows.lanes, row)
    code = KERNEL(library(kernel, with_numba=name == "numba")["kernel"])

    def run(buffer, begin, end, rows, row):
        data = buffer if isinstance(buffer, int) else ctypes.addressof((ctypes.c_char * len(buffer)).from_buffer(buffer)) if buffer else 0
        return code(data, begin, end, rows.state.ctypes.data, row)

    return run


def outcome(name: str, kernel: Kernel, message: bytes, rows, begin: int = 0, row: int = 0) -> tuple[object, ...]:
    """What a caller may see after one call, with the message somewhere in a larger buffer."""
    buffer = bytearray(bytes(begin) + message + b"\xee" * 8)
    result = engine(name, kernel)(buffer, begin, begin + len(message), rows, row)
    return (*rows.seen(result, 4), bytes(buffer)) if kernel.direction == "encode" else rows.seen(result, 4)
