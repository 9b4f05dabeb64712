"""A chunk on its way from the file to the records in it: decompressed, and compared with its checksum: by several threads at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.logs.reading.checksum import crc32
from rosetta_jit.logs.reading.compression import UNCOMPRESSED, Scratch, decompressed
from rosetta_jit.logs.reading.walking import Rows, Stop
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Packed:
    """What a chunk says of its content. A checksum of None is not checked."""

    compression: str
    size: int
    body: memoryview
    crc: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Content:
    """The records of a chunk, as far as they are whole and as they were written, and what is wrong with the chunk.

    ``walked`` are the first messages, where the thread that unpacked the chunk has looked for them: it has the records in its cache.
    """

    data: NDArray[np.uint8]
    problem: Diagnostic | None = None
    walked: tuple[Rows, Stop] | None = None


def nothing(problem: Diagnostic | None = None) -> Content:
    """The content of a chunk of which nothing can be read, or of no chunk."""
    return Content(np.empty(0, np.uint8), problem)


def bytes_of_work(sealed: Packed | Content) -> int:
    """The bytes that a chunk takes while it is decompressed, before and after; 0 of one that is not compressed."""
    match sealed:
        case Packed(compression, size, body) if compression not in UNCOMPRESSED:
            return len(body) + size
        case _:
            return 0


def unpacked(sealed: Packed | Content, log: str, at: int, scratch: Scratch, *, check: bool) -> Content:
    """The content of a chunk that begins at a place of a log; ``check`` asks to compare its checksum.

    Raises
    ------
    LogError
        The package is missing that decompresses it.
    """
    if isinstance(sealed, Content):
        return sealed
    data, wrong = decompressed(log, sealed.compression, sealed.body, sealed.size, scratch)
    if wrong:
        return Content(data, (words.chunk_damaged if data.size else words.chunk_unread)(log, at, wrong))
    if check and sealed.crc is not None and crc32(data) != sealed.crc:
        return nothing(words.checksum(log, at))
    return Content(data)
