"""No access leaves the message or a lane: both lie directly before, or behind, memory that may not be touched."""

from __future__ import annotations

import ctypes
import mmap
import sys

import numpy as np
import pytest

from rosetta_jit.kernel.state import ADDRESS, CAPACITY, lane_word
from tests.backends import kernels
from tests.backends.engines import engine
from tests.backends.holders import rows
from tests.backends.messages import hostile

PAGE = mmap.PAGESIZE
NO_ACCESS = 0
pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="mprotect by way of libc")


class Guarded:
    """Memory of some pages between two that fault."""

    def __init__(self, pages: int = 1) -> None:
        self.memory = mmap.mmap(-1, (pages + 2) * PAGE)
        start = ctypes.addressof(ctypes.c_char.from_buffer(self.memory))
        self.start, self.end = start + PAGE, start + (pages + 1) * PAGE
        protect = ctypes.CDLL(None, use_errno=True).mprotect
        protect.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int]
        assert protect(start, PAGE, NO_ACCESS) == 0
        assert protect(self.end, PAGE, NO_ACCESS) == 0

    def place(self, data: bytes, *, at_end: bool) -> int:
        address = self.end - len(data) if at_end else self.start
        ctypes.memmove(address, data, len(data))
        return address


@pytest.mark.parametrize("kernel", kernels.DECODERS, ids=lambda kernel: kernel.name)
@pytest.mark.parametrize("backend", ["llvm", "numba"])
def test_decoders_stay_inside(backend, kernel):
    message_memory, lane_memories = Guarded(), [Guarded(2) for _ in kernel.strides]
    run = engine(backend, kernel)
    for message in hostile(kernel.name, rounds=150):
        for at_end in (True, False):
            holder = rows(kernel)
            for number, (memory, lane) in enumerate(zip(lane_memories, holder.lanes, strict=True)):
                capacity = min(int(holder.state[lane_word(number, CAPACITY)]), 2 * PAGE // kernel.strides[number])
                holder.state[lane_word(number, CAPACITY)] = capacity
                holder.state[lane_word(number, ADDRESS)] = memory.place(bytes(lane[: capacity * kernel.strides[number]]), at_end=at_end)
            address = message_memory.place(message, at_end=at_end)
            assert run(address, 0, len(message), holder, 0) <= len(message)


def test_the_guard_bites():
    memory = Guarded()
    assert memory.end - memory.start == PAGE
    assert np.ctypeslib.as_array((ctypes.c_uint8 * PAGE).from_address(memory.start)).sum() == 0
