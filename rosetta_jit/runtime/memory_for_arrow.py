"""Memory of lanes that becomes an Arrow table's without a copy: the lanes get other memory before they are filled again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rosetta_jit.kernel.state import ADDRESS, lane_word
from rosetta_jit.runtime.memory import aligned

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.runtime.lanes import Lanes
    from rosetta_jit.runtime.rows import Room

FULL = 3, 4
"""Which part of a lane's memory an array must have to take all of it: the rest is lost to others for as long as the array lives."""

SPARE = 4
"""New memory is larger than what was taken by one of so many parts, so that messages of about the same size fit in and fill it."""


class Handed:
    """What tables may take, and took, of the lanes of one batch, which is filled again and again, and which nobody else changes.

    Only memory that was made here is handed over: the first memory of a lane belongs to all lanes of the batch.
    """

    __slots__ = ("_made", "_taken")

    def __init__(self) -> None:
        self._made: dict[int, int] = {}
        """Where the memory lies that was made here, by lane: a lane that grew has other memory."""
        self._taken: dict[int, tuple[int, Room]] = {}
        """The bytes that arrays of a lane have, and what gives new memory for them."""

    def takes(self, lanes: Lanes, lane: int, values: NDArray[Any], room: Room) -> bool:
        """Whether an array takes the memory of a lane, where its values lie; otherwise it must copy them."""
        buffer = lanes.buffers[lane]
        if not values.size or not np.may_share_memory(values, buffer):
            return False
        is_made = lanes.words[lane_word(lane, ADDRESS)] == self._made.get(lane)
        if is_made and values.nbytes * FULL[1] < buffer.size * FULL[0]:
            return False
        self._taken[lane] = values.nbytes, room
        return is_made

    def renew(self, lanes: Lanes) -> None:
        """Inside ``with lanes:``, before a filling: other memory for lanes whose memory was taken, or could have been."""
        for lane, (size, room) in self._taken.items():
            stride = lanes.plan.strides[lane]
            rows = (size + size // SPARE) // stride + 1
            lanes.move(lane, room(aligned(rows * stride, 8) // 8).view(np.uint8), rows)
            self._made[lane] = lanes.words[lane_word(lane, ADDRESS)]
        self._taken.clear()
