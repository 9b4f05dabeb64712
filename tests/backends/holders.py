"""Holders by hand: a state and its lanes, each in memory of a known size."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.kernel.state import (
    ADDRESS,
    CAPACITY,
    ERROR_INDICES,
    ERROR_OFFSET,
    ERROR_SITE,
    GROW_LANE,
    GROW_ROWS,
    STRIDE,
    USED,
    lane_word,
    state_words,
)

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Kernel

KERNEL = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64)


@dataclass(frozen=True, slots=True)
class Rows:
    """A holder without a class."""

    state: np.ndarray
    lanes: tuple[np.ndarray, ...]

    def seen(self, result: int, indices: int) -> tuple[object, ...]:
        """All that a caller may look at after a result: lanes count after a success alone."""
        if result >= 0:
            used = [int(self.state[lane_word(k, USED)]) for k in range(len(self.lanes))]
            return (result, used, [lane.tobytes() for lane in self.lanes])
        if result == -1:
            return (result, self.state[GROW_LANE : GROW_ROWS + 1].tolist())
        return (result, self.state[[ERROR_OFFSET, ERROR_SITE]].tolist(), self.state[ERROR_INDICES : ERROR_INDICES + indices].tolist())

    def copy(self) -> Rows:
        """The same in other memory."""
        state, lanes = self.state.copy(), tuple(lane.copy() for lane in self.lanes)
        for number, lane in enumerate(lanes):
            state[lane_word(number, ADDRESS)] = lane.ctypes.data
        return Rows(state, lanes)


def rows(kernel: Kernel, capacity: int = 40) -> Rows:
    strides = kernel.strides
    lanes = tuple(np.zeros(stride * capacity, np.uint8) for stride in strides)
    state = np.zeros(state_words(len(strides)), np.int64)
    for number, lane in enumerate(lanes):
        state[lane_word(number, ADDRESS)] = lane.ctypes.data
        state[lane_word(number, CAPACITY)] = capacity
        state[lane_word(number, USED)] = 0
        state[lane_word(number, STRIDE)] = strides[number]
    return Rows(state, lanes)
