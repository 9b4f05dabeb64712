"""Decoded messages of a channel, some megabytes at a time. Each message is decoded where it lies, without a copy of its bytes.

Chunks of logs may be small, and columns and tables are made of thousands of messages: so the messages of several blocks fill one batch.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from rosetta_jit.errors import DecodeError
from rosetta_jit.runtime.decoder import borrows, fill, filling_of
from rosetta_jit.runtime.message_spans import MessageSpans
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.api.decoder import Decoder
    from rosetta_jit.logs.base import Block
    from rosetta_jit.logs.reading.walking import Rows
    from rosetta_jit.runtime.batches.batch import Batch
    from rosetta_jit.runtime.batches.filling import Filling

OnError: TypeAlias = Literal["raise", "skip", "mask"]
CLOCKS = ("log_time", "publish_time")
"""The columns of times that a table has beside the fields of messages."""

BYTES, MESSAGES = 12 << 20, 49_152
"""The most that a part is made of; a longer message is alone. Each table costs more than its rows: with half of it, a tenth more."""

LARGE, LARGE_BYTES = 1 << 17, 16 << 20
"""From which size on messages are large, and the most that a part of these is made of: to make a table takes as long as to decode a
megabyte, however few messages it has."""


@dataclass(frozen=True, slots=True, eq=False)
class Refused:
    """A message that could not be decoded: when it was logged, and its bytes."""

    log_ns: int
    data: bytes


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Some decoded messages of a channel. It is good until the next part is asked for, whose messages take its memory.

    Attributes
    ----------
    batch
        The messages.
    log_ns, publish_ns
        Their times in nanoseconds since 1970.
    first
        The number of the first among all messages that are read.
    given
        How many were read, those that could not be decoded included.
    refused
        Of these, those that could not be decoded, as `Batch.errors` numbers them.
    """

    batch: Batch
    log_ns: NDArray[np.int64]
    publish_ns: NDArray[np.int64]
    first: int
    given: int
    refused: Mapping[int, Refused]


def nothing(decoder: Decoder) -> Part:
    """A part without messages."""
    times = np.empty(0, np.int64)
    return Part(decoder.many(b"", np.zeros(1, np.int64)), times, times, 0, 0, {})


class Collector:
    """Decodes messages of one channel into parts.

    Parameters
    ----------
    first
        How many messages of the channel were read before.
    size
        The most bytes that the messages of a part have together; if they are small, `BYTES`.
    expected
        How many messages there are, if that is known: memory is taken for as many as are going to be in a part.
    batch
        A batch of the decoder's that nobody uses any more: its memory is taken for the parts.
    """

    def __init__(
        self,
        decoder: Decoder,
        on_error: OnError,
        *,
        first: int = 0,
        size: int | None = None,
        expected: int | None = None,
        batch: Batch | None = None,
    ) -> None:
        self._decoder, self._first, self._expected = decoder, first, expected or 0
        self._size = LARGE_BYTES if size is None else size
        self._on_error: OnError = on_error
        self._batch = batch
        self._filling: Filling | None = None
        self._times = np.empty((2, MESSAGES), np.int64)
        self._bytes = 0
        self._refused: dict[int, Refused] = {}

    def parts(self, blocks: Iterable[Block]) -> Iterator[Part]:
        """The messages of all blocks."""
        for block in blocks:
            yield from self.put(block, block.rows)
        yield from self.rest()

    def put(self, block: Block, rows: Rows) -> Iterator[Part]:
        """Decode messages of a block; gives the parts that they make full.

        Raises
        ------
        DecodeError
            A message is not what its type promises; the path begins with its number among all.
        """
        if not len(rows):
            return
        sizes = rows.ends - rows.begins
        total, count = int(sizes.sum()), len(sizes)
        if total < LARGE * count and self._bytes + total <= min(BYTES, self._size) and self._count + count <= MESSAGES:
            self._take(block, rows)
            self._bytes += total
            if borrows(self._decoder):
                yield from self.rest()
            return
        done, ends = 0, np.cumsum(sizes)
        size = self._size if int(sizes.min()) >= LARGE else min(BYTES, self._size)
        while done < len(rows):
            before = int(ends[done - 1]) if done else 0
            most = max(int(np.searchsorted(ends, size - self._bytes + before, side="right")) - done, 0)
            taken = min(most, MESSAGES - self._count) or (0 if self._count else 1)
            if taken:
                self._take(block, rows.only(slice(done, done + taken)))
                self._bytes += int(ends[done + taken - 1]) - before
                done += taken
            if done < len(rows) or borrows(self._decoder):  # one batch borrows from one block
                yield from self.rest()

    @property
    def _count(self) -> int:
        return 0 if self._filling is None else self._filling.count

    def _take(self, block: Block, rows: Rows) -> None:
        filling = self._filling = self._filling or filling_of(self._decoder, self._likely(rows), self._batch, self._on_error)
        self._batch, first = filling.batch, filling.count
        count = first + len(rows)
        spans = MessageSpans(np.ascontiguousarray(rows.begins, np.int64), np.ascontiguousarray(rows.ends, np.int64), first=first)
        self._times[0, first:count], self._times[1, first:count] = rows.log_ns, rows.publish_ns
        try:
            with filling.batch.lanes as lanes:
                fill(self._decoder, filling, block.data, spans, count)
                lanes.source[0] = block.data.data if borrows(self._decoder) else None
        except DecodeError as error:
            number, _, path = error.path.removeprefix("[").partition("]")
            raise DecodeError(error.kind, f"[{self._first + int(number)}]{path}", error.detail, error.offset) from None
        for number in filling.batch.errors:
            if number >= first:
                begin, end = spans.span(number)
                self._refused[number] = Refused(int(self._times[0, number]), block.data[begin:end].tobytes())

    def _likely(self, rows: Rows) -> int:
        """How many messages a part is going to have that begins with some."""
        mean = max(1, int((rows.ends - rows.begins).sum()) // len(rows))
        size = self._size if mean >= LARGE else min(BYTES, self._size)
        return max(len(rows), min(size // mean, MESSAGES, self._expected - self._first))

    def rest(self) -> Iterator[Part]:
        """What is decoded and was not given yet; nothing is left."""
        filling = self._filling
        if filling is not None and filling.count:
            with filling.batch.lanes:
                batch = filling.end()
            log_ns, publish_ns = self._times[:, : filling.count]
            if len(batch) < filling.count:
                log_ns, publish_ns = log_ns[batch.kept], publish_ns[batch.kept]
            part = Part(batch, log_ns, publish_ns, self._first, filling.count, self._refused)
            self._first += filling.count
            self._filling, self._bytes, self._refused = None, 0, {}
            yield part
