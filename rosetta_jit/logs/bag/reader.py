"""Opening ROS 1's bags: by the index at the end, else record by record."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import LogError
from rosetta_jit.logs.bag.grammar import CHUNK_INFO, CONNECTION, BagGrammar, header_of, number, time_ns
from rosetta_jit.logs.bag.old import MAGIC as OLD_MAGIC
from rosetta_jit.logs.bag.old import OldBagReader
from rosetta_jit.logs.base import Block, Connection, Extent, Piece, Reader, Wanted, widened
from rosetta_jit.logs.limits import MAX_INDEX_BYTES
from rosetta_jit.logs.reading.chunked_records import PEEK, Records
from rosetta_jit.logs.reading.scan import Scanned
from rosetta_jit.logs.reading.segments import Chunk, Region, pieces_of, segments_of
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.logs.reading.storage import Storage

MAGIC = b"#ROSBAG V2.0\n"


@dataclass(frozen=True, slots=True)
class Contents:
    """What a bag has, and where."""

    segments: list[Chunk | Region]
    counts: Mapping[int, int | None]
    extent: Extent | None
    end: int


def open_bag(storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> Reader:
    """Open a bag of version 2.0 or 1.2; LogError where it is none of these."""
    start = storage.read(0, 32)
    if not start.startswith(b"#ROSBAG V"):
        raise LogError((words.not_a(storage.name, "bag"),))
    if start.startswith(OLD_MAGIC):
        return OldBagReader(storage, tell)
    if not start.startswith(MAGIC):
        raise LogError((words.old_version(storage.name, start.partition(b"\n")[0].decode("ascii", "replace")),))
    return BagReader(storage, tell, check=check)


class BagReader:
    """An open bag of version 2.0."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> None:
        self._storage, self._tell = storage, tell
        self._grammar = BagGrammar(storage.name, tell)
        self._records = Records(storage, self._grammar, tell, len(MAGIC), check=check)
        self._contents = self._indexed() or self._scanned()

    @property
    def connections(self) -> Mapping[int, Connection]:
        counts = self._contents.counts
        return {number: replace(each, count=counts.get(number, 0)) for number, each in self._grammar.connections.items()}

    @property
    def extent(self) -> Extent | None:
        return self._contents.extent

    @property
    def facts(self) -> Mapping[str, str]:
        chunks = [each for each in self._contents.segments if isinstance(each, Chunk)]
        facts = {"version": "2.0", "chunks": str(len(chunks))}
        if not chunks:
            return facts
        try:
            header, _ = header_of(self._storage.read(chunks[0].at, PEEK))
        except ValueError:
            return facts
        return facts | {"compression": header.get(b"compression", b"?").decode("ascii", "replace")}

    @property
    def pieces(self) -> Sequence[Piece]:
        return pieces_of(self._contents.segments)

    @property
    def works_ahead(self) -> bool:
        return self._records.works_ahead(self._contents.segments)

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        return self._records.blocks(self._contents.segments, wanted, self._contents.end)

    def _indexed(self) -> Contents | None:
        storage = self._storage
        try:
            header, _ = header_of(storage.read(len(MAGIC), PEEK))
            at, connections, chunks = number(header, b"index_pos", "<Q"), number(header, b"conn_count"), number(header, b"chunk_count")
        except ValueError as error:
            self._tell(words.bad_index(storage.name, str(error)))
            return None
        if not at:
            self._tell(words.unfinished(storage.name))
            return None
        if not len(MAGIC) < at <= storage.size or storage.size - at > MAX_INDEX_BYTES:
            self._tell(words.bad_index(storage.name, "it is outside of the file"))
            return None
        try:
            return self._of_index(storage.read(at, storage.size - at), at, connections, chunks)
        except (ValueError, struct.error) as error:
            self._tell(words.bad_index(storage.name, str(error)))
            self._grammar.connections.clear()
            return None

    def _of_index(self, data: bytes, end: int, connections: int, chunk_count: int) -> Contents:
        chunks, counts, extent = list[Chunk](), dict[int, int | None](), None
        view, place = memoryview(data), 0
        while place < len(data):
            header, at = header_of(view[place:])
            size = at + int(struct.unpack_from("<I", data, place + at - 4)[0])
            if size > len(data) - place:
                raise ValueError("it is cut short")
            record = data[place : place + size]
            op = number(header, b"op", "<B")
            if op == CONNECTION:
                self._grammar.define(record)
            elif op == CHUNK_INFO:
                chunk = _chunk_info(header, record[at:])
                chunks.append(chunk)
                for channel, count in (chunk.counts or {}).items():
                    counts[channel] = (counts.get(channel) or 0) + (count or 0)
                extent = _wider(extent, chunk)
            place += size
        if len(chunks) != chunk_count or len(self._grammar.connections) != connections:
            raise ValueError("it has not as many chunks or connections as the bag's header says")
        chunks.sort(key=lambda each: each.at)  # the index tells where chunks begin: what follows one, belongs to it
        ends = [*(each.at for each in chunks[1:]), end]
        chunks = [replace(each, size=behind - each.at) for each, behind in zip(chunks, ends, strict=False)]
        segments = segments_of(chunks, len(MAGIC), end, {})
        if segments is None:
            raise ValueError("the places of chunks cannot be true")
        return Contents(segments, counts, extent, end)

    def _scanned(self) -> Contents:
        end = self._storage.size
        found = Scanned(self._records, len(MAGIC), end)
        return Contents(found.segments, found.counts, None if found.times is None else Extent(*found.times), end)


def _chunk_info(header: dict[bytes, bytes], data: bytes) -> Chunk:
    counts = {int(conn): int(count) for conn, count in struct.iter_unpack("<II", data[: number(header, b"count") * 8])}
    times = time_ns(header.get(b"start_time", b"")), time_ns(header.get(b"end_time", b""))
    return Chunk(number(header, b"chunk_pos", "<Q"), 0, times, dict[int, "int | None"](counts) or None)


def _wider(extent: Extent | None, chunk: Chunk) -> Extent | None:
    return extent if chunk.times is None or not chunk.counts else widened(extent, *chunk.times)
