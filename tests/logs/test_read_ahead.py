"""Reading ahead: what waits, and which memory is used again."""

from __future__ import annotations

import time

import numpy as np

from rosetta_jit.logs.read_ahead import ahead
from rosetta_jit.logs.reading.compression import Scratch


def test_memory_that_is_shown_is_not_used_again():
    """Blocks wait while more are read: only what nobody holds any more is written over."""
    scratch = Scratch()
    first, second = scratch.room(100), scratch.room(50)
    assert not np.may_share_memory(first, second)
    address, view = first.ctypes.data, first.data[10:20]
    del first
    assert scratch.room(60).ctypes.data != address  # a view of its memory is left
    del view
    assert scratch.room(60).ctypes.data == address
    assert scratch.record(200).size == 200
    del second
    kept = [scratch.room(100) for _ in range(5)]
    assert len({each.ctypes.data for each in kept}) == 5


def test_little_waits_while_nobody_asks():
    """Six megabytes, or one block that is larger; who leaves early waits for nothing."""
    made = list[int]()

    def blocks(size, count):
        for number in range(count):
            made.append(number)
            yield size

    for size, most in ((1 << 20, 9), (64 << 20, 3)):
        made.clear()
        items = ahead(blocks(size, 100), int)
        assert next(items) == size
        before = -1
        while before != len(made):
            before = len(made)
            time.sleep(0.02)
        assert 2 <= len(made) <= most
        assert sum(1 for _ in items) == 99
    items = ahead(blocks(1, 1000), int)
    next(items)
    items.close()
