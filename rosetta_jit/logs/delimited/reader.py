"""Opening files of delimited protobuf messages: one channel, named after the file. Neither types nor times are in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import logs as words
from rosetta_jit.logs.base import Block, Connection, Piece, Wanted
from rosetta_jit.logs.limits import MAX_RECORD_BYTES, MAX_VARINT_BYTES
from rosetta_jit.logs.reading.blocks import blocks_of
from rosetta_jit.logs.reading.varints import varint

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.logs.reading.storage import Storage

WINDOW = 1 << 20


class DelimitedReader:
    """An open file of delimited messages."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> None:
        del check  # it has no checksums
        self._storage, self._tell = storage, tell
        count = sum(len(block.rows) for block in self.blocks(Wanted()))
        self.connections = {0: Connection(0, storage.path.name.partition(".")[0], "", "protobuf", count=count)}
        self.extent, self.facts, self.pieces = None, dict[str, str](), (Piece(storage.size),)

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        del wanted
        return blocks_of((0, 0, 0, each) for each in self._messages())

    def _messages(self) -> Iterator[bytes]:
        at, base, window = 0, 0, b""
        while at < self._storage.size:
            if at + MAX_VARINT_BYTES > base + len(window):
                base, window = at, self._storage.read(at, WINDOW)
            try:
                size, behind = varint(window, at - base)
            except ValueError:
                self._tell((words.log_cut if at + MAX_VARINT_BYTES > self._storage.size else words.damaged)(self._storage.name, at))
                return
            begin = base + behind
            if size > min(self._storage.size - begin, MAX_RECORD_BYTES):
                self._tell(words.log_cut(self._storage.name, at))
                return
            inside = behind + size <= len(window)
            yield window[behind : behind + size] if inside else self._storage.read(begin, size)
            at = begin + size
