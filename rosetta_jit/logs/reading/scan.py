"""What a log without an index turns out to have, found by reading all of its records."""

from __future__ import annotations

from rosetta_jit.logs.base import Block
from rosetta_jit.logs.reading.chunked_records import Records, add_counts
from rosetta_jit.logs.reading.segments import Chunk, Region


class Scanned:
    """What a log without an index turns out to have."""

    def __init__(self, records: Records, start: int, end: int) -> None:
        self.segments: list[Chunk | Region] = []
        self.counts: dict[int, int | None] = {}
        self.times: tuple[int, int] | None = None
        loose = start
        for item in records.items(start, end):
            match item:
                case Block():
                    add_counts(self.counts, item.rows)
                    self._time(int(item.rows.log_ns.min()), int(item.rows.log_ns.max()))
                case Chunk():
                    self._chunk(item, records)
                    if item.at > loose:
                        self.segments.append(Region(loose, item.at))
                    self.segments.append(item)
                    loose = item.at + item.size
        if loose < end:
            self.segments.append(Region(loose, end))

    def _chunk(self, chunk: Chunk, records: Records) -> None:
        for channel, count in records.learn(chunk).items():
            self.counts[channel] = (self.counts.get(channel) or 0) + (count or 0)
        if chunk.times is not None:
            self._time(*chunk.times)

    def _time(self, first: int, last: int) -> None:
        self.times = (first, last) if self.times is None else (min(first, self.times[0]), max(last, self.times[1]))
