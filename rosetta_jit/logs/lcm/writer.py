"""Writing LCM's event logs: a sync word and a head before each message, all numbers big-endian."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, BinaryIO

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError

if TYPE_CHECKING:
    from rosetta_jit.logs.base import Connection

HEAD = struct.Struct(">IQqII")
SYNC = 0xEDA1DA01


class LcmWriter:
    """An event log. Channels have no types in it, and times are microseconds."""

    def __init__(self, name: str, file: BinaryIO) -> None:
        self._name, self._file = name, file
        self._channels: list[bytes] = []
        self._events = 0

    def connect(self, connection: Connection) -> int:
        if connection.encoding != "lcm":
            raise LogError((words.not_carried(self._name, connection.topic, connection.encoding, "messages of LCM alone"),))
        self._channels.append(connection.topic.encode())
        return len(self._channels) - 1

    def write(self, number: int, log_ns: int, publish_ns: int, data: bytes) -> None:
        del publish_ns
        channel = self._channels[number]
        self._file.write(HEAD.pack(SYNC, self._events, log_ns // 1000, len(channel), len(data)) + channel + data)
        self._events += 1

    def finish(self) -> None:
        """There is no index."""
