"""The records of a bag: a header of fields `name=value`, and data. https://wiki.ros.org/Bags/Format/2.0."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Literal

from rosetta_jit.catalogue import logs as words
from rosetta_jit.logs.base import Connection
from rosetta_jit.logs.reading.chunked_records import Head
from rosetta_jit.logs.reading.chunks import Packed
from rosetta_jit.logs.reading.fields import Fields

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.logs.reading.chunked_records import Kind

MESSAGE, BAG_HEADER, INDEX, CHUNK, CHUNK_INFO, CONNECTION = range(2, 8)

KINDS: dict[int, Kind] = {
    MESSAGE: "message",
    BAG_HEADER: "other",
    INDEX: "index",
    CHUNK: "chunk",
    CHUNK_INFO: "other",
    CONNECTION: "definition",
}


def header_of(record: bytes | memoryview) -> tuple[dict[bytes, bytes], int]:
    """The header of a record, and where its data begin; ValueError if it is damaged."""
    fields = Fields(record)
    header = fields.inner()
    found: dict[bytes, bytes] = {}
    while header.left:
        name, equals, value = header.bytes(header.u32()).partition(b"=")
        if not equals:
            raise ValueError(f"a field without `=`: {name[:40]!r}")
        found[name] = value
    return found, fields.at + 4


def number(header: dict[bytes, bytes], name: bytes, form: str = "<I") -> int:
    """A number of a header; ValueError if it is not there."""
    value = header.get(name, b"")
    if len(value) != struct.calcsize(form):
        raise ValueError(f"there is no {name.decode()}")
    return int(struct.unpack(form, value)[0])


def time_ns(data: bytes) -> int:
    """A time: seconds and nanoseconds."""
    seconds, nanoseconds = struct.unpack("<II", data)
    return int(seconds) * 10**9 + int(nanoseconds)


class BagGrammar:
    """What is defined so far, and what each record is."""

    walk: Literal["bag"] = "bag"

    def __init__(self, name: str, tell: Callable[[Diagnostic], None]) -> None:
        self._name, self._tell = name, tell
        self.connections: dict[int, Connection] = {}

    def head(self, peek: bytes) -> Head:
        try:
            header, at = header_of(peek)
            size = at + int(struct.unpack_from("<I", peek, at - 4)[0])
            kind: Kind = KINDS.get(number(header, b"op", "<B"), "damaged")
        except (ValueError, struct.error):
            return Head("damaged")
        return Head(kind, size)

    def define(self, record: bytes) -> None:
        header, at = header_of(record)
        data, _ = header_of(struct.pack("<I", len(record) - at) + record[at:])
        conn, topic = number(header, b"conn"), _text(header.get(b"topic", b""))
        sum_, definition = _text(data.get(b"md5sum", b"")), data.get(b"message_definition", b"")
        details = {"md5sum": sum_} | {name: _text(data[name.encode()]) for name in ("callerid", "latching") if name.encode() in data}
        language = "ros1msg" if definition.strip() or sum_ == EMPTY_MD5 else ""
        found = Connection(conn, topic, _text(data.get(b"type", b"")), "ros1", language, definition, details=details)
        known = self.connections.setdefault(conn, found)
        if (known.topic, known.type, known.schema) != (found.topic, found.type, found.schema):
            self._tell(words.redefined(self._name, f"connection {conn}", known.topic))

    def counted(self, record: bytes) -> tuple[int, int]:
        header, _ = header_of(record)
        return number(header, b"conn"), number(header, b"count")

    def packed(self, record: memoryview) -> Packed:
        header, at = header_of(record)
        promised = int(struct.unpack_from("<I", record, at - 4)[0]) if len(record) >= at else 0
        return Packed(_text(header.get(b"compression", b"none")), number(header, b"size"), record[at : at + promised])

    def knows(self, channel: int) -> bool:
        return channel in self.connections


EMPTY_MD5 = "d41d8cd98f00b204e9800998ecf8427e"
"""The sum of a type without fields, whose definition is empty."""


def _text(value: bytes) -> str:
    return value.decode("utf-8", "replace")
