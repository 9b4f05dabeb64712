"""Empty messages of recursive types: `decode` returns a new object before it sets up the functions that make objects of rows."""

from __future__ import annotations

import numpy as np

from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.interpret import run
from rosetta_jit.kernel.state import CAPACITY, USED, lane_word, state_words
from rosetta_jit.kernel.traits import asks_host


def print_empty_message(unit: Unit, identifier: str) -> list[str]:
    """The lines that return the object of a message without a byte; none where its decoder sets up no such functions."""
    kernel = unit.kernels["borrow"]
    is_plain = not (unit.state or asks_host([kernel]))
    return ["if not end:", f"    return {identifier}()"] if unit.layout.recursive and is_plain and _is_first_value(unit) else []


def _is_first_value(unit: Unit) -> bool:
    """Whether a message without a byte is valid, and all of its fields have their first values: the kernel is run to see that."""
    kernel = unit.kernels["borrow"]
    state, row = np.zeros(state_words(kernel.lanes), np.int64), bytearray(b"\xff" * kernel.strides[0])
    state[[lane_word(0, CAPACITY), lane_word(0, USED)]] = 1
    lanes = [row, *(bytearray() for _ in range(1, kernel.lanes))]
    return run(kernel, b"", 0, 0, state, lanes, 0) == 0 and not any(row)
