"""Writing MCAP files, by the `mcap` package: chunks of a megabyte, compressed by zstd, and an index."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, BinaryIO

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError

if TYPE_CHECKING:
    from rosetta_jit.logs.base import Connection


TIME = (1 << 64) - 1
"""Times are unsigned."""


class McapWriter:
    """An MCAP file. A type without a definition is written without one."""

    def __init__(self, name: str, file: BinaryIO) -> None:
        try:
            package: Any = import_module("mcap.writer")
        except ImportError:
            raise LogError((words.needs(name, "mcap", "logs"),)) from None
        self._writer = package.Writer(file)
        self._schemas: dict[tuple[str, str, bytes], int] = {}
        self._sequences: dict[int, int] = {}
        self._started = False

    def connect(self, connection: Connection) -> int:
        if not self._started:
            self._writer.start(profile={"ros1": "ros1", "cdr": "ros2"}.get(connection.encoding, ""), library="rosetta_jit")
            self._started = True
        key = connection.type, connection.schema_encoding, connection.schema
        if key not in self._schemas:
            self._schemas[key] = self._writer.register_schema(*key) if connection.type else 0
        number = self._writer.register_channel(connection.topic, connection.encoding, self._schemas[key], dict(connection.details))
        self._sequences[number] = 0
        return int(number)

    def write(self, number: int, log_ns: int, publish_ns: int, data: bytes) -> None:
        self._writer.add_message(number, log_ns & TIME, data, publish_ns & TIME, self._sequences[number])
        self._sequences[number] += 1

    def finish(self) -> None:
        if not self._started:
            self._writer.start(library="rosetta_jit")
        self._writer.finish()
