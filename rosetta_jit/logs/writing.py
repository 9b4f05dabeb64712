"""Writing logs: a format's writer is given connections and messages; what it cannot carry is refused before anything is written."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.file_errors import whole
from rosetta_jit.startup.garbage import imported

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path

    from rosetta_jit.logs.base import Connection

WRITERS = {
    ".mcap": "rosetta_jit.logs.mcap.writer:McapWriter",
    ".bag": "rosetta_jit.logs.bag.writer:BagWriter",
    ".lcmlog": "rosetta_jit.logs.lcm.writer:LcmWriter",
}
"""By the suffix of the file."""


class Writer(Protocol):
    """A log that is being written."""

    def connect(self, connection: Connection) -> int:
        """Add a stream of messages; gives the number by which it is written. LogError if the format cannot carry it."""
        ...

    def write(self, number: int, log_ns: int, publish_ns: int, data: bytes) -> None:
        """Write a message."""
        ...

    def finish(self) -> None:
        """Write the index."""
        ...


@contextmanager
def written(path: Path) -> Generator[Writer]:
    """A new log. It has its name when it is whole; until then, and if the process is killed, it is called `….part`.

    Raises
    ------
    LogError
        No format has such files.
    """
    place = next((each for suffix, each in WRITERS.items() if path.name.endswith(suffix)), None)
    if place is None:
        raise LogError((words.no_writer(str(path), WRITERS),))
    module, _, name = place.partition(":")
    make = getattr(imported(module), name)
    with whole(path) as part, part.open("wb") as file:
        writer: Writer = make(str(path), file)
        yield writer
        writer.finish()
