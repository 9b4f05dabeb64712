"""The records of MCAP: an opcode, a length of 64 bits, and fields. https://mcap.dev/spec, section "Records"."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Literal

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.logs.base import Connection
from rosetta_jit.logs.reading.chunked_records import Head, Kind
from rosetta_jit.logs.reading.chunks import Packed
from rosetta_jit.logs.reading.fields import Fields
from rosetta_jit.startup.dataclass import dataclass

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, DATA_END = 0x0B, 0x0F
PREFIX = struct.Struct("<BQ")
"""Opcode and length of each record."""

SIGN = 1 << 63
"""The sign of a time, in a number of 64 bits."""

CONTENT = struct.Struct("<16xQI")
"""Of a chunk: its size before it was compressed, and its checksum, behind the times of its messages."""

KINDS: dict[int, Kind] = {
    0: "damaged",
    FOOTER: "end",
    SCHEMA: "definition",
    CHANNEL: "definition",
    MESSAGE: "message",
    CHUNK: "chunk",
    MESSAGE_INDEX: "index",
    DATA_END: "end",
}


@dataclass(frozen=True, slots=True)
class Schema:
    """A type that channels refer to."""

    name: str
    encoding: str
    data: bytes


def times_between(first: int, last: int) -> tuple[int, int] | None:
    """The first time and the last of some, in nanoseconds since 1970: those of 2⁶³ and more are before it, as ROS 2 writes them.

    MCAP calls its times unsigned, so some before 1970 and some after are the other way round, and say neither bound: None.
    """
    early, late = (first ^ SIGN) - SIGN, (last ^ SIGN) - SIGN
    return (early, late) if early <= late else None


class McapGrammar:
    """What is defined so far, and what each record is."""

    walk: Literal["mcap"] = "mcap"

    def __init__(self, name: str, tell: Callable[[Diagnostic], None]) -> None:
        self._name, self._tell = name, tell
        self._schemas: dict[int, Schema] = {}
        self.connections: dict[int, Connection] = {}

    def head(self, peek: bytes) -> Head:
        opcode, length = PREFIX.unpack_from(peek)
        kind, size = KINDS.get(opcode, "other"), PREFIX.size + length
        times = None
        if kind == "chunk" and len(peek) >= PREFIX.size + 16:
            first, last = struct.unpack_from("<QQ", peek, PREFIX.size)
            times = times_between(first, last) if first or last else None  # writers say 0 and 0 of a chunk without messages
        return Head(kind, size, times)

    def define(self, record: bytes) -> None:
        fields = Fields(record, PREFIX.size)
        if record[0] == SCHEMA:
            number = fields.u16()
            self._new_schema(number, Schema(fields.text(), fields.text(), fields.bytes(fields.u32())))
            return
        number, schema = fields.u16(), fields.u16()
        topic, encoding = fields.text(), fields.text()
        details = {each.text(): each.text() for each in fields.inner().while_left()}
        type_ = self._schemas.get(schema, Schema("", "", b""))
        if schema and schema not in self._schemas:
            self._tell(words.no_schema(self._name, topic, schema))
        found = Connection(number, topic, type_.name, encoding, type_.encoding, type_.data, details=details)
        known = self.connections.setdefault(number, found)
        if (known.topic, known.type, known.schema) != (found.topic, found.type, found.schema):
            self._tell(words.redefined(self._name, f"channel {number}", known.topic))

    def _new_schema(self, number: int, schema: Schema) -> None:
        if self._schemas.setdefault(number, schema) != schema:
            self._tell(words.redefined(self._name, f"schema {number}", schema.name))

    def counted(self, record: bytes) -> tuple[int, int]:
        fields = Fields(record, PREFIX.size)
        return fields.u16(), fields.u32() // 16

    def packed(self, record: memoryview) -> Packed:
        fields = Fields(record, PREFIX.size)
        size, crc = fields.some(CONTENT)
        compression, promised = fields.text(), fields.u64()
        return Packed(compression, size, fields.view(min(promised, fields.left)), crc or None)

    def knows(self, channel: int) -> bool:
        return channel in self.connections
