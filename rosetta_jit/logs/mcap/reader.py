"""Opening MCAP files: by the summary at the end, else record by record."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import LogError
from rosetta_jit.logs.base import Block, Connection, Extent, Piece, Wanted
from rosetta_jit.logs.limits import MAX_SUMMARY_BYTES
from rosetta_jit.logs.mcap.grammar import (
    CHANNEL,
    CHUNK_INDEX,
    FOOTER,
    HEADER,
    MAGIC,
    PREFIX,
    SCHEMA,
    STATISTICS,
    McapGrammar,
    times_between,
)
from rosetta_jit.logs.reading.chunked_records import Records
from rosetta_jit.logs.reading.fields import Fields
from rosetta_jit.logs.reading.scan import Scanned
from rosetta_jit.logs.reading.segments import Chunk, Region, pieces_of, segments_of
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.logs.reading.storage import Storage

FOOTER_SIZE = PREFIX.size + 20


@dataclass(frozen=True, slots=True)
class Summary:
    """What the end of a file tells of the rest."""

    segments: list[Chunk | Region]
    counts: Mapping[int, int | None]
    extent: Extent | None
    facts: Mapping[str, str]
    end: int


class McapReader:
    """An open MCAP file."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> None:
        if storage.read(0, len(MAGIC)) != MAGIC:
            raise LogError((words.not_a(storage.name, "MCAP file"),))
        self._storage, self._tell, self._check = storage, tell, check
        self._grammar = McapGrammar(storage.name, tell)
        self._records = Records(storage, self._grammar, tell, len(MAGIC), check=check)
        self._summary = self._summarised() or self._scanned()

    @property
    def connections(self) -> Mapping[int, Connection]:
        counts = self._summary.counts
        return {number: replace(each, count=counts.get(number, 0)) for number, each in self._grammar.connections.items()}

    @property
    def extent(self) -> Extent | None:
        return self._summary.extent

    @property
    def facts(self) -> Mapping[str, str]:
        return self._summary.facts

    @property
    def pieces(self) -> Sequence[Piece]:
        return pieces_of(self._summary.segments)

    @property
    def works_ahead(self) -> bool:
        return self._records.works_ahead(self._summary.segments)

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        return self._records.blocks(self._summary.segments, wanted, self._summary.end)

    def _summarised(self) -> Summary | None:
        """By the summary, None where there is none that can be used."""
        storage = self._storage
        tail = storage.read(max(0, storage.size - FOOTER_SIZE - len(MAGIC)), FOOTER_SIZE + len(MAGIC))
        if len(tail) < FOOTER_SIZE + len(MAGIC) or tail[FOOTER_SIZE:] != MAGIC or PREFIX.unpack_from(tail) != (FOOTER, 20):
            self._tell(words.unfinished(storage.name))
            return None
        fields = Fields(tail, PREFIX.size)
        start, _, crc = fields.u64(), fields.u64(), fields.u32()
        end = storage.size - FOOTER_SIZE - len(MAGIC)
        if not start:
            return None
        if not len(MAGIC) <= start <= end or end - start > MAX_SUMMARY_BYTES:
            self._tell(words.bad_index(storage.name, "the summary is outside of the file"))
            return None
        data = storage.read(start, end - start)
        if self._check and crc and zlib.crc32(data + tail[: FOOTER_SIZE - 4]) != crc:
            self._tell(words.bad_index(storage.name, "the checksum of the summary is another one"))
            return None
        try:
            return self._of_records(data, start)
        except ValueError as error:
            self._tell(words.bad_index(storage.name, str(error)))
            self._grammar.connections.clear()
            return None

    def _of_records(self, data: bytes, end: int) -> Summary | None:
        chunks, behind, definitions = list[Chunk](), dict[int, int](), list[bytes]()
        counts: dict[int, int | None] | None = None
        times, facts = None, self._header()
        fields = Fields(data)
        compressions: set[str] = set()
        while fields.left:
            opcode, record = fields.bytes(1)[0], fields.u64()
            content = Fields(fields.view(record))
            if opcode in (SCHEMA, CHANNEL):
                definitions.append(bytes(PREFIX.pack(opcode, record)) + content.bytes(record))
            elif opcode == CHUNK_INDEX:
                chunk, index_size, compression = _chunk_index(content)
                chunks.append(chunk)
                behind[chunk.at] = index_size
                compressions.add(compression)
            elif opcode == STATISTICS:
                counts, times = _statistics(content)
        if counts is None or not _are_all(definitions, {*counts, *(number for each in chunks for number in each.counts or ())}):
            return None
        for each in sorted(definitions, key=lambda each: each[0]):
            self._grammar.define(each)
        segments = segments_of(chunks, len(MAGIC), end, behind)
        if segments is None:
            raise ValueError("the places of chunks cannot be true")
        if chunks:
            facts |= {"chunks": str(len(chunks)), "compression": ", ".join(sorted(each or "none" for each in compressions))}
        return Summary(segments, counts, _extent(times, counts, chunks), facts, end)

    def _header(self) -> dict[str, str]:
        """What the first record says."""
        peek = self._storage.read(len(MAGIC), 4096)
        try:
            fields = Fields(peek)
            if fields.bytes(1)[0] != HEADER:
                return {}
            fields.u64()
            return {name: text for name, text in (("profile", fields.text()), ("library", fields.text())) if text}
        except ValueError:
            return {}

    def _scanned(self) -> Summary:
        """Record by record."""
        end = self._storage.size
        found = Scanned(self._records, len(MAGIC), end)
        chunks = sum(isinstance(each, Chunk) for each in found.segments)
        extent = None if found.times is None else Extent(*found.times)
        return Summary(found.segments, found.counts, extent, self._header() | ({"chunks": str(chunks)} if chunks else {}), end)


def _are_all(definitions: Sequence[bytes], used: Collection[int]) -> bool:
    """Whether definitions are those of all channels that are used, and of the schemas that they name: a summary need not repeat them."""
    schemas, channels = {0}, dict[int, int]()
    for each in definitions:
        fields = Fields(each, PREFIX.size)
        if each[0] == SCHEMA:
            schemas.add(fields.u16())
        else:
            number = fields.u16()
            channels[number] = fields.u16()
    return channels.keys() >= set(used) and schemas.issuperset(channels.values())


def _chunk_index(fields: Fields) -> tuple[Chunk, int, str]:
    first, last, at, size = fields.u64(), fields.u64(), fields.u64(), fields.u64()
    channels: dict[int, int | None] = {}
    for each in fields.inner().while_left():
        channels[each.u16()] = None
        each.u64()
    index_size, compression = fields.u64(), fields.text()
    times = times_between(first, last) if channels or first or last else None
    return Chunk(at, size, times, channels or None), index_size, compression


def _statistics(fields: Fields) -> tuple[dict[int, int | None], tuple[int, int] | None]:
    """How many messages each channel has, and the first time and the last, if they are told."""
    messages = fields.u64()
    fields.view(2 + 4 + 4 + 4 + 4)
    times = times_between(fields.u64(), fields.u64()) if messages else None
    return {each.u16(): each.u64() for each in fields.inner().while_left()}, times


def _extent(times: tuple[int, int] | None, counts: Mapping[int, int | None], chunks: Sequence[Chunk]) -> Extent | None:
    """When the first and the last message of a log came: by its statistics, else by its chunks."""
    found = [times] if times is not None else [each.times for each in chunks if each.counts]
    if not any(counts.values()) or None in found or not found:
        return None
    known = [each for each in found if each is not None]
    return Extent(min(first for first, _ in known), max(last for _, last in known))
