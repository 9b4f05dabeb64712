"""Logs of records, of which some are chunks of compressed records: what MCAP and ROS 1's bags have in common.

    log     = record*
    record  = message | definition | chunk | index | other
    chunk   = record*, compressed

An index at the end says where the chunks are. Whatever it does not cover is read record by record; so is a log that has none, because its
writer was killed, or one whose index lies.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from typing import TYPE_CHECKING, Literal, Protocol, TypeAlias

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.logs.base import Block, Wanted
from rosetta_jit.logs.limits import MAX_RECORD_BYTES
from rosetta_jit.logs.reading.chunks import Content, Packed, bytes_of_work, nothing, unpacked
from rosetta_jit.logs.reading.compression import Scratch
from rosetta_jit.logs.reading.segments import Chunk, Region
from rosetta_jit.logs.reading.side_by_side import side_by_side
from rosetta_jit.logs.reading.walking import Rows, Stop, Why, walk
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.logs.reading.storage import Storage

WINDOW = 4 << 20
"""Bytes that are read at once where records are not in chunks."""

MOST_AT_ONCE = 16 << 20
"""Bytes of a segment that are read before its chunk has told its own size."""

PEEK = 4096
"""Bytes from which it is told what a record is."""


@dataclass(frozen=True, slots=True)
class Found:
    """A segment by its number, as it is in the file.

    Attributes
    ----------
    size
        Of its chunk, as that says itself.
    is_true
        Whether there is a chunk, and the file has no more of it than the index says; of a region, that is so.
    sealed
        The chunk's content before it is decompressed; a `Content` where nothing is left to do.
    """

    number: int
    size: int
    is_true: bool
    sealed: Packed | Content


Kind: TypeAlias = Literal["message", "definition", "chunk", "index", "other", "end", "damaged"]


@dataclass(frozen=True, slots=True)
class Head:
    """What a record is, and its size; nothing is known of a damaged one."""

    kind: Kind
    size: int = 0
    times: tuple[int, int] | None = None


class Grammar(Protocol):
    """What the formats differ in."""

    @property
    def walk(self) -> Literal["mcap", "bag"]: ...

    def head(self, peek: bytes) -> Head:
        """What the record is that begins so; there are at least nine bytes."""
        ...

    def define(self, record: bytes) -> None:
        """Learn from a definition. ValueError on a damaged one."""
        ...

    def counted(self, record: bytes) -> tuple[int, int]:
        """Channel and number of messages that a record of an index tells of the chunk before it. ValueError on a damaged one."""
        ...

    def packed(self, record: memoryview) -> Packed:
        """The content of a chunk, which may be cut short. ValueError if not even its head is whole."""
        ...

    def knows(self, channel: int) -> bool:
        """Whether a channel is defined."""
        ...


class Records:
    """Reads the records of one log."""

    def __init__(self, storage: Storage, grammar: Grammar, tell: Callable[[Diagnostic], None], start: int, *, check: bool) -> None:
        self.start = start
        self._storage, self._grammar, self._tell, self._check = storage, grammar, tell, check
        self._scratch = Scratch()

    def blocks(self, segments: Sequence[Chunk | Region], wanted: Wanted, end: int) -> Iterator[Block]:
        """The messages of segments, which lie in order; the log's records end at ``end``.

        A segment's own are those of the records that begin between it and the next. Where the index lies, they are looked for from the
        last chunk on that it told truly; so they are the same whether segments are read together or one by one.
        """
        try:
            yield from self._blocks(segments, wanted, end, self._scratch)
        finally:
            self._scratch.settle()

    def _blocks(self, segments: Sequence[Chunk | Region], wanted: Wanted, end: int, scratch: Scratch) -> Iterator[Block]:
        chosen = range(len(segments)) if wanted.pieces is None else range(len(segments))[wanted.pieces.start : wanted.pieces.stop]
        numbers = [number for number in chosen if segments[number].piece.has(wanted)]  # between chunks it is out of the caches each time
        found = (self._found(number, segments[number], scratch) for number in numbers)

        def content_of(each: Found) -> Content:
            return self._unpacked(each.sealed, segments[each.number].at, scratch)

        for each, content in side_by_side(found, content_of, lambda each: bytes_of_work(each.sealed)):
            segment = segments[each.number]
            if each.is_true:
                blocks = self._segment(segment, each, content, wanted, scratch, end)
            else:
                self._tell(words.index_lies(self._storage.name, segment.at))
                own = range(segment.at, segments[chosen.stop].at if chosen.stop < len(segments) else end)
                blocks = self._region(self._true_place(segments[: each.number]), end, wanted, scratch, own)
            del content  # its memory is free when its messages are read
            for block in blocks:
                yield Block(block.data, block.rows, each.number)
            if not each.is_true:
                return

    def works_ahead(self, segments: Sequence[Chunk | Region]) -> bool:
        """Whether threads unpack chunks before `blocks` comes to them: where they are compressed, as the first one is."""
        first = next((each.at for each in segments if isinstance(each, Chunk)), None)
        return first is not None and bytes_of_work(self._sealed(memoryview(self._storage.read(first, PEEK)), first)) > 0

    def _found(self, number: int, segment: Chunk | Region, scratch: Scratch) -> Found:
        """A segment, whose chunk is read, and not yet decompressed."""
        if isinstance(segment, Region):
            return Found(number, 0, True, nothing())
        size, there = segment.size, self._storage.size - segment.at  # a chunk that the file's end cuts is as long as what is there
        if size > MOST_AT_ONCE:  # an index of a bag tells where chunks begin, not where they end
            _, head = self._head(segment.at, size)
            if head.kind != "chunk" or min(head.size, there) > size:
                return Found(number, 0, False, nothing())
            size = min(head.size, there)
        record = self._storage.read_into(segment.at, scratch.record(size))
        head = self._grammar.head(bytes(record[:PEEK])) if len(record) > 9 else Head("damaged")
        is_true = head.kind == "chunk" and min(head.size, there) <= segment.size
        return Found(number, head.size, is_true, self._sealed(record, segment.at) if is_true else nothing())

    def _segment(
        self, segment: Chunk | Region, found: Found, content: Content, wanted: Wanted, scratch: Scratch, end: int
    ) -> Iterator[Block]:
        """The messages of a segment that is where the index says; its last record may end in the next one, if that is not."""
        if isinstance(segment, Region):
            yield from self._region(segment.at, end, wanted, scratch, range(segment.at, segment.end))
            return
        yield from self._walked(content, segment.at)
        if found.size < segment.size:
            behind = range(segment.at + found.size, segment.at + segment.size)
            yield from self._region(behind.start, end, wanted, scratch, behind)

    def _true_place(self, before: Sequence[Chunk | Region]) -> int:
        """Where the last chunk begins that is where the index says; the log's first record, if there is none."""
        for segment in reversed(before):
            peek = self._storage.read(segment.at, PEEK)
            if isinstance(segment, Chunk) and len(peek) > 9 and self._grammar.head(peek).kind == "chunk":
                return segment.at
        return before[0].at if before else self.start

    def _region(self, at: int, end: int, wanted: Wanted, scratch: Scratch, own: range | None = None) -> Iterator[Block]:
        for item in self.items(at, end, own):
            match item:
                case Block():
                    yield item
                case Chunk():
                    if item.piece.has(wanted):
                        yield from self._content(self._storage.read_into(item.at, scratch.record(item.size)), item.at, scratch)

    def items(self, at: int, end: int, own: range | None = None) -> Iterator[Chunk | Block]:
        """Go from record to record: the chunks, and the messages outside of chunks. Definitions are learned on the way.

        Only those are given that begin within ``own``.
        """
        own = own or range(at, end)
        while at < min(end, own.stop):
            left = end - at
            peek, head = self._head(at, min(left, own.stop - at))
            if head.kind == "damaged" and own.stop < end:  # it may end behind what the index says
                peek, head = self._head(at, left)
            is_cut = len(peek) < 9 or head.size > left
            if head.kind == "damaged" or (is_cut and head.kind != "chunk"):
                self._tell((words.log_cut if is_cut else words.damaged)(self._storage.name, at))
                return
            match head.kind:
                case "chunk":
                    if head.size > left:
                        self._tell(words.log_cut(self._storage.name, at))
                    chunk, at = self._described(Chunk(at, min(head.size, left), head.times), end)
                    if chunk.at in own:
                        yield chunk
                case "message":
                    at = yield from self._messages(at, end, own)
                case "definition":
                    self._define(self._storage.read(at, head.size), at)
                    at += head.size
                case "end":
                    return
                case _:
                    at += head.size

    def _head(self, at: int, left: int) -> tuple[bytes, Head]:
        """What the record is that begins somewhere, by so many bytes at most."""
        peek = self._storage.read(at, min(PEEK, left))
        return peek, self._grammar.head(peek) if len(peek) >= 9 else Head("damaged")

    def _described(self, chunk: Chunk, end: int) -> tuple[Chunk, int]:
        """A chunk with what the index records behind it tell, and where those end."""
        at, counts = chunk.at + chunk.size, dict[int, int | None]()
        while at < end and len(peek := self._storage.read(at, min(PEEK, end - at))) >= 9:
            head = self._grammar.head(peek)
            if head.kind != "index" or head.size > end - at:
                break
            try:
                channel, count = self._grammar.counted(self._storage.read(at, head.size))
            except ValueError:
                self._tell(words.damaged(self._storage.name, at))
                break
            counts[channel] = count
            at += head.size
        return Chunk(chunk.at, chunk.size, chunk.times, counts or None), at

    def learn(self, chunk: Chunk) -> dict[int, int | None]:
        """How many messages of which channel a chunk has: it is decompressed where that, or the channel itself, is not known."""
        if chunk.counts is not None and all(map(self._grammar.knows, chunk.counts)):
            return dict(chunk.counts)
        counts: dict[int, int | None] = {}
        for block in self._content(memoryview(self._storage.read(chunk.at, chunk.size)), chunk.at, Scratch()):
            add_counts(counts, block.rows)
        return counts

    def _content(self, record: memoryview, at: int, scratch: Scratch) -> Iterator[Block]:
        """The messages of a chunk."""
        yield from self._walked(self._unpacked(self._sealed(record, at), at, scratch), at)

    def _unpacked(self, sealed: Packed | Content, at: int, scratch: Scratch) -> Content:
        """The content of a chunk, with its first messages."""
        content = unpacked(sealed, self._storage.name, at, scratch, check=self._check)
        if not content.data.size:
            return content
        return Content(content.data, content.problem, walk(self._grammar.walk, content.data, 0, memory=scratch.rows))

    def _sealed(self, record: memoryview, at: int) -> Packed | Content:
        """What a chunk says of its content."""
        try:
            return self._grammar.packed(record)
        except ValueError as error:
            return nothing(words.chunk_damaged(self._storage.name, at, str(error)))

    def _walked(self, content: Content, at: int) -> Iterator[Block]:
        """The messages in the content of a chunk."""
        data, is_reported = content.data, content.problem is not None
        if content.problem is not None:
            self._tell(content.problem)
        place, walked = 0, content.walked
        while place < data.size:
            (rows, stop), walked = walked or walk(self._grammar.walk, data, place), None
            if len(rows):
                yield Block(data, rows)
            place = self._inside(data, stop, at, is_reported=is_reported)

    def _inside(self, data: NDArray[np.uint8], stop: Stop, at: int, *, is_reported: bool) -> int:
        """Where to go on in a chunk: behind the definition that stopped the walk, or at the end."""
        if stop.why in (Why.END, Why.ROOM):
            return stop.at
        peek = data[stop.at : stop.at + PEEK].tobytes()
        head = self._grammar.head(peek) if len(peek) >= 9 and stop.why is Why.OTHER else Head("damaged")
        if head.kind == "damaged" or head.size > data.size - stop.at:
            if not is_reported:
                self._tell(words.chunk_damaged(self._storage.name, at, f"its records break off at byte {stop.at} of {data.size}"))
            return data.size
        if head.kind == "definition":
            self._define(data[stop.at : stop.at + head.size].tobytes(), at)
        return stop.at + head.size

    def _messages(self, at: int, end: int, own: range) -> Generator[Block, None, int]:
        """The messages from a place on, as far as they lie together, window by window; the place behind them."""
        needed = 0
        while at < min(end, own.stop):
            data = np.frombuffer(self._storage.read(at, min(max(WINDOW, needed), end - at)), np.uint8)
            rows, stop = walk(self._grammar.walk, data, 0)
            if len(rows):
                begins = rows.begins + at
                rows = rows.only((begins >= own.start) & (begins < own.stop)) if at < own.start or at + stop.at > own.stop else rows
            if len(rows):
                yield Block(data, rows)
            at += stop.at
            if stop.why is Why.OTHER:
                return at
            if stop.why is Why.CUT and stop.at == 0:
                needed = 2 * max(WINDOW, needed)
                if data.size >= min(end - at, MAX_RECORD_BYTES):
                    self._tell(words.log_cut(self._storage.name, at))
                    return end
            elif stop.why is Why.BROKEN:
                self._tell(words.damaged(self._storage.name, at))
                return end
        return at

    def _define(self, record: bytes, at: int) -> None:
        try:
            self._grammar.define(record)
        except ValueError as error:
            self._tell(words.bad_definition(self._storage.name, at, str(error)))


def add_counts(counts: dict[int, int | None], rows: Rows) -> None:
    """Count messages by channel."""
    channels, numbers = np.unique(rows.channels, return_counts=True)
    for channel, number in zip(channels.tolist(), numbers.tolist(), strict=True):
        counts[channel] = (counts.get(channel) or 0) + number
