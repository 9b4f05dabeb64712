"""Writing ROS 1's bags of version 2.0: chunks, the index of each behind it, and the index of all at the end."""

from __future__ import annotations

import struct
from typing import BinaryIO

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.logs.bag.grammar import BAG_HEADER, CHUNK, CHUNK_INFO, CONNECTION, INDEX, MESSAGE
from rosetta_jit.logs.base import Connection

MAGIC = b"#ROSBAG V2.0\n"
HEADER_SIZE = 4096
"""The first record is filled up with blanks to this size, so that it can be written again."""

CHUNK_SIZE = 768 * 1024
END_NS = 10**9 << 32
"""From here on, in 2106, seconds have more than 32 bits."""


def record(data: bytes, **fields: bytes) -> bytes:
    """A record."""
    parts = [f"{name}=".encode() + value for name, value in fields.items()]
    header = b"".join(struct.pack("<I", len(part)) + part for part in parts)
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def u32(value: int) -> bytes:
    """A number of 32 bits."""
    return struct.pack("<I", value)


def op(value: int) -> bytes:
    """What a record is."""
    return bytes([value])


def time_of(time_ns: int) -> bytes:
    """Seconds and nanoseconds."""
    return struct.pack("<II", *divmod(time_ns, 10**9))


class BagWriter:
    """A bag. It holds messages of ROS 1; times are 32 bits of seconds and nanoseconds."""

    def __init__(self, name: str, file: BinaryIO) -> None:
        self._name, self._file = name, file
        self._connections: list[bytes] = []
        self._infos: list[bytes] = []
        self._chunk, self._index = bytearray(), dict[int, list[tuple[int, int]]]()
        self._introduced: set[int] = set()
        file.write(MAGIC + self._header(0))

    def _header(self, index_at: int) -> bytes:
        fields = {"op": op(BAG_HEADER), "index_pos": struct.pack("<Q", index_at)}
        fields |= {"conn_count": u32(len(self._connections)), "chunk_count": u32(len(self._infos))}
        return record(b" " * (HEADER_SIZE - len(record(b"", **fields))), **fields)

    def connect(self, connection: Connection) -> int:
        if connection.encoding != "ros1":
            raise LogError((words.not_carried(self._name, connection.topic, connection.encoding, "messages of ROS 1 alone"),))
        number, topic = len(self._connections), connection.topic.encode()
        about = {"topic": topic, "type": connection.type.encode(), "md5sum": connection.details.get("md5sum", "*").encode()}
        about |= {"message_definition": connection.schema}
        about |= {name: connection.details[name].encode() for name in ("callerid", "latching") if name in connection.details}
        described = record(b"", **about)[4:-4]
        self._connections.append(record(described, op=op(CONNECTION), conn=u32(number), topic=topic))
        return number

    def write(self, number: int, log_ns: int, publish_ns: int, data: bytes) -> None:
        del publish_ns
        if not 0 <= log_ns < END_NS:
            raise LogError((words.no_time(self._name, log_ns),))
        if number not in self._introduced:
            self._introduced.add(number)
            self._chunk += self._connections[number]
        self._index.setdefault(number, []).append((log_ns, len(self._chunk)))
        self._chunk += record(data, op=op(MESSAGE), conn=u32(number), time=time_of(log_ns))
        if len(self._chunk) >= CHUNK_SIZE:
            self._flush()

    def _flush(self) -> None:
        if not self._chunk:
            return
        at = self._file.tell()
        self._file.write(record(bytes(self._chunk), op=op(CHUNK), compression=b"none", size=u32(len(self._chunk))))
        for number, entries in self._index.items():
            data = b"".join(time_of(time) + u32(offset) for time, offset in entries)
            self._file.write(record(data, op=op(INDEX), ver=u32(1), conn=u32(number), count=u32(len(entries))))
        times = [time for entries in self._index.values() for time, _ in entries]
        first, last = time_of(min(times, default=0)), time_of(max(times, default=0))
        counts = b"".join(u32(number) + u32(len(entries)) for number, entries in self._index.items())
        fields = {"op": op(CHUNK_INFO), "ver": u32(1), "chunk_pos": struct.pack("<Q", at), "start_time": first, "end_time": last}
        self._infos.append(record(counts, **fields, count=u32(len(self._index))))
        self._chunk, self._index = bytearray(), {}

    def finish(self) -> None:
        self._flush()
        at = self._file.tell()
        self._file.write(b"".join([*self._connections, *self._infos]))
        self._file.seek(len(MAGIC))
        self._file.write(self._header(at))
