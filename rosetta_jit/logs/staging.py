"""Messages of many small chunks, put together so that one call decodes them: columns are made of thousands of messages, not of ten."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.logs.walking import gather_into
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from rosetta_jit.logs.base import Block
    from rosetta_jit.logs.walking import Rows

BYTES, MESSAGES = 4 << 20, 16_384
"""What is decoded at once; a longer message is alone."""

LARGE = 1 << 17
"""Messages from here on are decoded where they lie, one by one: to copy them takes longer."""


@dataclass(frozen=True, slots=True, eq=False)
class Staged:
    """Messages one behind the other, in memory that is used again for the next."""

    data: NDArray[np.uint8]
    offsets: NDArray[np.int64]
    log_ns: NDArray[np.int64]
    publish_ns: NDArray[np.int64]


class Staging:
    """The memory."""

    def __init__(self, size: int = BYTES) -> None:
        self._data = np.empty(size, np.uint8)
        self._offsets = np.zeros(MESSAGES + 1, np.int64)
        self._times = np.empty((2, MESSAGES), np.int64)
        self._count = 0

    def filled(self, blocks: Iterable[Block]) -> Iterator[Staged]:
        """The messages of all blocks, as many at once as there is room for."""
        for block in blocks:
            yield from self.put(block, block.rows)
        yield from self.flushed()

    def put(self, block: Block, rows: Rows) -> Iterator[Staged]:
        """Add messages of a block; gives those that have to leave for them."""
        done, sizes = 0, rows.ends - rows.begins
        if len(rows) and int(sizes.min()) >= LARGE:
            yield from self.flushed()
            yield from (_alone(block, rows.only(slice(each, each + 1))) for each in range(len(rows)))
            return
        while done < len(rows):
            taken = self._fitting(sizes[done:])
            if taken:
                self._take(block, rows.only(slice(done, done + taken)))
                done += taken
            if done < len(rows):
                yield from self.flushed()

    def _fitting(self, sizes: NDArray[np.int64]) -> int:
        """How many of the next messages there is room for."""
        used = int(self._offsets[self._count])
        if not self._count and sizes[0] > self._data.size:
            self._data = np.empty(int(sizes[0]), np.uint8)
        sizes = sizes[: MESSAGES - self._count]
        return int(np.searchsorted(np.cumsum(sizes), self._data.size - used, side="right"))

    def _take(self, block: Block, rows: Rows) -> None:
        first, count = self._count, len(rows)
        gather_into(block.data, rows.begins, rows.ends, self._data, self._offsets[first : first + count + 1])
        self._times[:, first : first + count] = rows.log_ns, rows.publish_ns
        self._count += count

    def flushed(self) -> Iterator[Staged]:
        """All that is there; nothing is left."""
        count = self._count
        if count:
            offsets = self._offsets[: count + 1]
            yield Staged(self._data[: int(offsets[-1])], offsets, self._times[0, :count], self._times[1, :count])
        self._count = 0


def _alone(block: Block, rows: Rows) -> Staged:
    """A message where it lies."""
    begin, end = int(rows.begins[0]), int(rows.ends[0])
    return Staged(block.data[begin:end], np.array([0, end - begin]), rows.log_ns, rows.publish_ns)
