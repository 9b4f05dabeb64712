"""What a log of records consists of, as its index says, or as it turned out: chunks, and regions between them.

segment = chunk | region
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.logs.base import Piece
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


@dataclass(frozen=True, slots=True)
class Chunk:
    """Where a chunk is, and what is known of it before it is read.

    Attributes
    ----------
    times
        Of its first and its last message.
    counts
        How many messages of which channel it has; None where that is not known, and the count where the channel alone is.
    """

    at: int
    size: int
    times: tuple[int, int] | None = None
    counts: Mapping[int, int | None] | None = None

    @property
    def piece(self) -> Piece:
        """What others know of it."""
        return Piece(self.size, self.times, frozenset(self.counts) if self.counts else None)


@dataclass(frozen=True, slots=True)
class Region:
    """A stretch of records that no index covers."""

    at: int
    end: int

    @property
    def piece(self) -> Piece:
        """What others know of it: nothing but its size."""
        return Piece(self.end - self.at)


def pieces_of(segments: Sequence[Chunk | Region]) -> tuple[Piece, ...]:
    """Segments as what can be read alone; of a log without records one that is empty."""
    return tuple(each.piece for each in segments) or (Piece(0),)


def segments_of(chunks: Iterable[Chunk], start: int, end: int, behind: Mapping[int, int]) -> list[Chunk | Region] | None:
    """Chunks of an index, and the regions between them; ``behind`` says how much of an index follows a chunk. None if they overlap."""
    found: list[Chunk | Region] = []
    at = start
    for chunk in sorted(chunks, key=lambda each: each.at):
        if chunk.at < at or chunk.size < 9 or chunk.at + chunk.size > end:
            return None
        if chunk.at > at:
            found.append(Region(at, chunk.at))
        found.append(chunk)
        at = min(chunk.at + chunk.size + behind.get(chunk.at, 0), end)
    if at < end:
        found.append(Region(at, end))
    return found
