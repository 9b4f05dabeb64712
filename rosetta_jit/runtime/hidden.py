"""Hidden lanes: memory that kernels have besides a holder's fields, for what they compute on the way. Made when a kernel first needs it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.kernel.state import ADDRESS, CAPACITY, LANE_WORDS
from rosetta_jit.runtime.memory import address_of, aligned, aligned_bytes

if TYPE_CHECKING:
    from numpy.typing import NDArray

INITIAL_BYTES = 256
"""What a hidden lane has room for before it grows."""


class Hidden:
    """The hidden lanes of one holder or batch. What is in them is nobody's between two messages, so any kernel may use any of them.

    Attributes
    ----------
    buffers : list of ndarray of uint8
        The bytes of each lane.
    """

    __slots__ = ("_words", "buffers")

    def __init__(self) -> None:
        self.buffers: list[NDArray[np.uint8]] = []
        self._words = np.zeros(0, np.int64)

    @property
    def address(self) -> int:
        """Where the words of the lanes lie, as `rosetta_jit.kernel.state` has them."""
        return self._words.__array_interface__["data"][0]

    def grow(self, lane: int, size: int) -> None:
        """As many lanes as this one needs to be there, and in it so many bytes more, at least twice as many as before."""
        while len(self.buffers) <= lane:
            self.buffers.append(aligned_bytes(INITIAL_BYTES))
        if size > 0:
            old = self.buffers[lane].size
            self.buffers[lane] = aligned_bytes(aligned(max(2 * old, old + size)))
        self._words = np.zeros(LANE_WORDS * len(self.buffers), np.int64)
        self._words[ADDRESS::LANE_WORDS] = [address_of(buffer) for buffer in self.buffers]
        self._words[CAPACITY::LANE_WORDS] = [buffer.size for buffer in self.buffers]
