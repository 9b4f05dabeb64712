"""Opening recordings, `.rec` and `.rec.xz`: one channel, named after the file, of messages whose type nobody has written down."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.logs.base import Block, Connection, Extent, Piece, Wanted
from rosetta_jit.logs.reading.blocks import blocks_of
from rosetta_jit.recording import RecordingError, read_messages

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.logs.reading.storage import Storage


XZ = b"\xfd7zXZ\0"


class RecordingReader:
    """An open recording."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> None:
        del check  # xz has its own checksums
        self._path, self._tell = storage.local(".rec.xz" if storage.read(0, len(XZ)) == XZ else ".rec"), tell
        times = [(int(block.rows.log_ns.min()), int(block.rows.log_ns.max()), len(block.rows)) for block in self.blocks(Wanted())]
        self.extent = Extent(min(each[0] for each in times), max(each[1] for each in times)) if times else None
        count = sum(each[2] for each in times)
        self.connections = {0: Connection(0, storage.path.name.partition(".")[0], "", "yarp", count=count)}
        self.facts, self.pieces = dict[str, str](), (Piece(0),)

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        del wanted
        return blocks_of(self._messages())

    def _messages(self) -> Iterator[tuple[int, int, int, bytes]]:
        try:
            for each in read_messages(self._path):
                time_ns = _nanoseconds(each.time_s)
                yield 0, time_ns, time_ns, each.data
        except RecordingError as error:
            for problem in error.diagnostics:
                self._tell(problem)


def _nanoseconds(time_s: float) -> int:
    """A time as an integer: 0 for what is none."""
    return round(time_s * 1e6) * 1000 if abs(time_s) < 9e9 else 0
