"""Bags of version 1.2, which ROS wrote until 2010: no chunks, and every message names its topic, its type and its md5 sum.

    bag     = "#ROSBAG V1.2", record*
    record  = header of fields `name=value`, data        as in version 2.0
    message = op 2, topic, type, md5, sec, nsec, [latching, callerid]: the message's bytes
    type    = op 1, topic, type, md5, def                before the first message of a topic
    index   = op 4, at the end of the file: where the messages of a topic are

The index is not needed: all headers are read when a bag is opened, and none of the messages' bytes. The constants are those of
`rosbag/constants.h`, https://docs.ros.org/en/noetic/api/rosbag_storage/html/c++/constants_8h.html.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.logs.bag.grammar import EMPTY_MD5, header_of, number
from rosetta_jit.logs.base import Block, Connection, Extent, Piece, Wanted, widened
from rosetta_jit.logs.limits import MAX_HEADER_BYTES
from rosetta_jit.logs.reading.blocks import blocks_of
from rosetta_jit.logs.reading.chunked_records import PEEK
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.logs.reading.storage import Storage

MAGIC = b"#ROSBAG V1.2\n"
DEFINITION, MESSAGE, INDEX = 1, 2, 4
WINDOW = 1 << 20
"""Bytes that are read at once."""


@dataclass(frozen=True, slots=True)
class _Record:
    """The header of a record, and where its data lie."""

    at: int
    op: int
    fields: dict[bytes, bytes]
    begin: int
    end: int


class OldBagReader:
    """An open bag of version 1.2."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None]) -> None:
        self._storage, self._tell = storage, tell
        self._definitions: dict[tuple[bytes, bytes], bytes] = {}
        self._numbers: dict[tuple[bytes, bytes, bytes], int] = {}
        self._indexed, self._is_whole = set[bytes](), False
        has_index = self._has_index()
        self.extent: Extent | None = None
        self.facts, self.pieces = {"version": "1.2"}, (Piece(storage.size),)
        counts = dict[int, int]()
        for channel, time_ns, _, _ in self._messages():
            counts[channel] = counts.get(channel, 0) + 1
            self.extent = widened(self.extent, time_ns, time_ns)
        if has_index and self._is_whole and any(topic not in self._indexed for topic, _, _ in self._numbers):
            self._tell(words.bad_index(storage.name, "it has not all topics"))
        self.connections = {each: replace(self._defined(key), count=counts[each]) for key, each in self._numbers.items()}

    def _has_index(self) -> bool:
        """Whether the bag has an index where its first record tells; says if not: its writer was stopped, or it is cut."""
        first = next(self._records(), None)
        try:
            at = number(first.fields, b"index_pos", "<Q") if first is not None else 0
        except ValueError:
            at = 0
        if not at:
            self._tell(words.unfinished(self._storage.name))
        elif at >= self._storage.size:
            self._tell(words.bad_index(self._storage.name, "it is outside of the file"))
        return 0 < at < self._storage.size

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        return blocks_of(
            (channel, time_ns, time_ns, self._storage.read(begin, end - begin))
            for channel, time_ns, begin, end in self._messages()
            if (wanted.connections is None or channel in wanted.connections) and wanted.overlaps(time_ns, time_ns)
        )

    def _messages(self) -> Iterator[tuple[int, int, int, int]]:
        """Of each message its channel, its time, and where it lies."""
        for record in self._records():
            try:
                key = record.fields.get(b"topic", b""), record.fields.get(b"type", b""), record.fields.get(b"md5", b"")
                if record.op == INDEX:
                    self._indexed.add(key[0])
                elif record.op == DEFINITION:
                    self._definitions.setdefault(key[1:], record.fields.get(b"def", b""))
                elif record.op == MESSAGE:
                    time_ns = number(record.fields, b"sec") * 10**9 + number(record.fields, b"nsec")
                    yield self._numbers.setdefault(key, len(self._numbers)), time_ns, record.begin, record.end
            except ValueError as error:
                self._tell(words.bad_definition(self._storage.name, record.at, str(error)))

    def _defined(self, key: tuple[bytes, bytes, bytes]) -> Connection:
        topic, type_, sum_ = (each.decode("utf-8", "replace") for each in key)
        schema = self._definitions.get(key[1:], b"")
        language = "ros1msg" if schema.strip() or sum_ == EMPTY_MD5 else ""
        return Connection(self._numbers[key], topic, type_, "ros1", language, schema, details={"md5sum": sum_})

    def _records(self) -> Iterator[_Record]:
        """The headers of all records; after damage nothing tells where the next one is."""
        at, base, window, size = len(MAGIC), 0, b"", self._storage.size
        while at < size:
            if not base <= at <= base + len(window) - PEEK:
                base, window = at, self._storage.read(at, WINDOW)
            record = self._record(at, window[at - base : at - base + PEEK]) or self._record(at, self._storage.read(at, MAX_HEADER_BYTES))
            if record is None:
                self._tell(words.damaged(self._storage.name, at) if size - at > PEEK else words.log_cut(self._storage.name, at))
                return
            if record.end > size:
                self._tell(words.log_cut(self._storage.name, at))
                return
            yield record
            at = record.end
        self._is_whole = True

    def _record(self, at: int, data: bytes) -> _Record | None:
        """The record that begins so; None where the header does not end there, or is none."""
        try:
            header, begin = header_of(data)
            size = int(struct.unpack_from("<I", data, begin - 4)[0])
            return _Record(at, number(header, b"op", "<B"), header, at + begin, at + begin + size)
        except (ValueError, struct.error):
            return None
