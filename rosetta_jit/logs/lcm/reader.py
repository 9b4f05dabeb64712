"""Opening LCM's event logs, which have no index: all of it is walked. After damage the next sync word is looked for."""

from __future__ import annotations

import secrets
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import LogError
from rosetta_jit.logs.base import Block, Connection, Extent, Piece, Wanted, widened
from rosetta_jit.logs.limits import MAX_RECORD_BYTES
from rosetta_jit.logs.reading.chunked_records import WINDOW, add_counts
from rosetta_jit.logs.reading.walking import Rows, Why, walk
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.logs.reading.storage import Storage

SYNC = bytes.fromhex("eda1da01")
PIECE = 64 << 20
"""Bytes of the file that are read alone, or somewhat more."""

HEAD = 28
"""Bytes of an event before its channel's name."""


class LcmReader:
    """An open event log of LCM."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> None:
        del check  # it has no checksums
        if storage.read(0, len(SYNC)) != SYNC:
            raise LogError((words.not_a(storage.name, "event log of LCM"),))
        self._storage, self._tell = storage, tell
        self._seed = secrets.randbits(64)
        self._numbers: dict[int, int] = {}
        self.connections: dict[int, Connection] = {}
        counts: dict[int, int | None] = {}
        self.extent: Extent | None = None
        self.facts = dict[str, str]()
        self._marks = [0]
        for at, block in self._walked(0, storage.size):
            if at - self._marks[-1] >= PIECE:
                self._marks.append(at)
            add_counts(counts, block.rows)
            self.extent = widened(self.extent, int(block.rows.log_ns.min()), int(block.rows.log_ns.max()))
        self.connections = {number: replace(each, count=counts.get(number, 0)) for number, each in self.connections.items()}

    @property
    def pieces(self) -> Sequence[Piece]:
        ends = [*self._marks[1:], self._storage.size]
        return [Piece(end - at) for at, end in zip(self._marks, ends, strict=True)]

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        marks = [*self._marks, self._storage.size]
        pieces = wanted.pieces or range(len(self._marks))
        for at, block in self._walked(marks[pieces.start], marks[min(pieces.stop, len(marks) - 1)]):
            yield replace(block, piece=bisect_right(self._marks, at) - 1)

    def _walked(self, at: int, end: int) -> Iterator[tuple[int, Block]]:
        """The messages between two places at which events begin, and where each block of them does."""
        needed = WINDOW
        while at < end:
            data = self._storage.array(at, min(needed, end - at))
            rows, stop = walk("lcm", data, 0, seed=self._seed)
            needed = WINDOW
            if len(rows):
                yield at, Block(data, self._numbered(data, rows))
            at += stop.at
            if stop.why is Why.CUT and at + max(stop.size, HEAD) <= end and stop.size <= MAX_RECORD_BYTES:
                needed = max(WINDOW, stop.size)
            elif stop.why in (Why.CUT, Why.OTHER):
                at = self._behind_damage(at, cut=stop.why is Why.CUT)

    def _behind_damage(self, at: int, *, cut: bool) -> int:
        """Where the next event begins behind a place that is none; the end of the file, if none does."""
        place, end = at + 1, self._storage.size
        while place < end:
            found = self._storage.read(place, WINDOW).find(SYNC)
            if found >= 0:
                self._tell(words.skipped(self._storage.name, at, place + found - at))
                return place + found
            place += WINDOW - len(SYNC) + 1
        self._tell(words.log_cut(self._storage.name, at) if cut else words.skipped(self._storage.name, at, end - at))
        return end

    def _numbered(self, data: NDArray[np.uint8], rows: Rows) -> Rows:
        """Rows with the numbers of channels in place of their names' hashes."""
        hashes, first, inverse = np.unique(rows.channels, return_index=True, return_inverse=True)
        numbers = np.empty(len(hashes), np.int64)
        for place in np.argsort(first).tolist():  # as they come: the hashes are others in each process
            numbers[place] = self._number(int(hashes[place]), data, rows, int(first[place]))
        return replace(rows, channels=numbers[inverse])

    def _number(self, key: int, data: NDArray[np.uint8], rows: Rows, row: int) -> int:
        number = self._numbers.setdefault(key, len(self._numbers))
        if number not in self.connections:
            begin, end = int(rows.begins[row]), int(rows.ends[row])
            before = int(rows.ends[row - 1]) if row else 0
            head = data[before:begin].tobytes()
            size = int.from_bytes(head[HEAD - 8 : HEAD - 4], "big")
            name = head[len(head) - size :].decode("utf-8", "replace")
            fingerprint = data[begin : min(begin + 8, end)].tobytes().hex()
            details = {"fingerprint": f"0x{fingerprint}"} if len(fingerprint) == 16 else {}
            self.connections[number] = Connection(number, name, "", "lcm", details=details)
        return number
