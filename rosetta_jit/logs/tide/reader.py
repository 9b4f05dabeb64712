"""Opening TIDE files: blocks of a tag, a length of 64 bits and content; channels, chunks of entries, and indices.

    file  = TIDE (CHAN | CHNK | INDX)*
    CHNK  = chunk u32, count u32, start u64, end u64, compression u8, entry*
    entry = channel u32, time in ns u64, size u32, that many bytes

Its writer never compresses and repeats no definitions, so that all heads of entries are read, and none of their bytes. An event of RSB is a
`Notification` in an entry: what comes out is the payload, with the time at which it was sent.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import LogError
from rosetta_jit.logs.base import Block, Connection, Extent, Piece, Wanted, widened
from rosetta_jit.logs.limits import MAX_DEFINITION_BYTES, MAX_RECORD_BYTES
from rosetta_jit.logs.reading.blocks import blocks_of
from rosetta_jit.logs.reading.fields import Fields
from rosetta_jit.logs.reading.varints import fields
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.logs.reading.storage import Storage

HEAD = 12
TIDE_SIZE = 10
CHUNK_HEAD, ENTRY_HEAD = 25, struct.Struct("<IQI")
EVENT = re.compile(r"rsb-event(?:-0\.(\d+))?:(.*)", re.DOTALL)


class TideReader:
    """An open TIDE file."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> None:
        del check  # it has no checksums
        head = storage.read(0, HEAD + TIDE_SIZE)
        if head[:4] != b"TIDE" or len(head) < HEAD + TIDE_SIZE:
            raise LogError((words.not_a(storage.name, "TIDE file"),))
        if head[HEAD]:
            raise LogError((words.old_version(storage.name, f"TIDE {head[HEAD]}.{head[HEAD + 1]}"),))
        self._storage, self._tell = storage, tell
        self.connections: dict[int, Connection] = {}
        self._data_fields: dict[int, int] = {}
        self._chunks: list[tuple[int, int]] = []
        self.extent: Extent | None = None
        self._scan()
        counts = dict.fromkeys(self.connections, 0)
        for channel, time_ns, _, _ in self._entries():
            counts[channel] = counts.get(channel, 0) + 1
            self.extent = widened(self.extent, time_ns, time_ns)
        self.connections = {number: replace(each, count=counts[number]) for number, each in self.connections.items()}
        self.facts, self.pieces = {"chunks": str(len(self._chunks))}, (Piece(storage.size),)

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        return blocks_of(self._messages(wanted))

    def _scan(self) -> None:
        """Find the blocks. The length of the first is not that of its content, which has ten bytes whatever it says."""
        storage, at = self._storage, HEAD + TIDE_SIZE
        while at < storage.size:
            head = storage.read(at, HEAD)
            tag, size = head[:4], int.from_bytes(head[4:], "little")
            if tag not in (b"CHAN", b"CHNK", b"INDX") or len(head) < HEAD:
                at = self._behind_damage(at)
                continue
            if size > storage.size - at - HEAD:
                self._tell(words.log_cut(storage.name, at))
            if tag == b"CHAN":
                self._define(at, size)
            elif tag == b"CHNK":
                self._chunks.append((at + HEAD, min(at + HEAD + size, storage.size)))
            at += HEAD + size

    def _behind_damage(self, at: int) -> int:
        """The next place at which a block seems to begin."""
        place = at + 1
        while place < self._storage.size:
            found = re.search(rb"CHAN|CHNK|INDX", self._storage.read(place, 1 << 20))
            if found is not None:
                self._tell(words.skipped(self._storage.name, at, place + found.start() - at))
                return place + found.start()
            place += (1 << 20) - 3
        self._tell(words.log_cut(self._storage.name, at))
        return self._storage.size

    def _define(self, at: int, size: int) -> None:
        content = Fields(self._storage.read(at + HEAD, min(size, MAX_DEFINITION_BYTES)))
        try:
            number = content.u32()
            name = content.bytes(content.bytes(1)[0]).decode("utf-8", "replace")
            type_, source = content.text(), content.text()
        except (ValueError, IndexError) as error:
            self._tell(words.bad_definition(self._storage.name, at, str(error)))
            return
        event = EVENT.fullmatch(type_)
        if event is None:
            self.connections[number] = Connection(number, name, type_, "", details={"source": source})
            return
        schema = event[2]
        self._data_fields[number] = 8 if event[1] in ("4", "5") else 9
        encoding = "protobuf" if schema.startswith(".") else schema
        topic = name.removesuffix(f":{schema}")
        self.connections[number] = Connection(number, topic, schema.removeprefix("."), encoding, details={"source": source})

    def _entries(self) -> Iterator[tuple[int, int, int, int]]:
        """Channel, time and place of the bytes of each entry."""
        for begin, end in self._chunks:
            head = self._storage.read(begin, CHUNK_HEAD)
            if len(head) < CHUNK_HEAD or head[24]:
                why = f"it is compressed ({head[24]}), which no writer does" if len(head) == CHUNK_HEAD else "it is cut short"
                self._tell(words.chunk_damaged(self._storage.name, begin, why))
                continue
            at = begin + CHUNK_HEAD
            while at < end:
                entry = self._storage.read(at, min(ENTRY_HEAD.size, end - at))
                size = int.from_bytes(entry[12:], "little")
                if len(entry) < ENTRY_HEAD.size or size > min(end - at - ENTRY_HEAD.size, MAX_RECORD_BYTES):
                    self._tell(words.chunk_damaged(self._storage.name, begin, f"its entries break off at byte {at}"))
                    break
                channel, time_ns, _ = ENTRY_HEAD.unpack(entry)
                if channel in self.connections:
                    yield channel, min(time_ns, (1 << 63) - 1), at + ENTRY_HEAD.size, size
                else:
                    self._tell(words.unknown_channel(self._storage.name, channel))
                at += ENTRY_HEAD.size + size

    def _messages(self, wanted: Wanted) -> Iterator[tuple[int, int, int, bytes]]:
        for channel, time_ns, at, size in self._entries():
            if wanted.connections is None or channel in wanted.connections:
                data = self._storage.read(at, size)
                if channel not in self._data_fields:
                    yield channel, time_ns, time_ns, data
                    continue
                try:
                    payload, sent_ns = _payload(data, self._data_fields[channel])
                except (ValueError, TypeError) as error:
                    self._tell(words.chunk_damaged(self._storage.name, at, f"an event is damaged: {error}"))
                    continue
                yield channel, time_ns, sent_ns or time_ns, payload


def _payload(event: bytes, number: int) -> tuple[bytes, int]:
    """What an event carries, and when it was sent, in nanoseconds; 0 if it does not tell."""
    payload, sent_us = b"", 0
    for field, value in fields(event):
        if field == number and isinstance(value, bytes):
            payload = value
        elif field == 15 and isinstance(value, bytes):
            sent_us = next((int(each) for name, each in fields(value) if name == 3 and isinstance(each, int)), 0)
    return payload, sent_us * 1000 if sent_us < 1 << 53 else 0
