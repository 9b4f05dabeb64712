"""What a log is to the rest: channels, blocks of messages, and a reader that gives both. No reader knows what the messages mean.

log   = channel*, block*
block = bytes, and a row a message: its channel, its times, where it lies
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol, cast

from rosetta_jit.startup.dataclass import dataclass, field
from rosetta_jit.startup.garbage import object_at

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.logs.reading.storage import Storage
    from rosetta_jit.logs.reading.walking import Rows


@dataclass(frozen=True, slots=True)
class Connection:
    """A stream of messages of one type within a log.

    Attributes
    ----------
    number
        What the log's records call it.
    topic
        Its name: a topic, a scope, a channel of LCM.
    type
        The name of its type; empty where the log does not tell.
    encoding
        Of its messages, as `Decoder.of` calls it: ``ros1``, ``cdr``, ``protobuf``, ``lcm``, ``yarp``; else what the log says.
    schema_encoding
        The language of ``schema``, as MCAP names it: ``ros1msg``, ``ros2msg``, ``ros2idl``, ``omgidl``, ``protobuf``; may be empty.
    schema
        The definition of the type.
    count
        How many messages there are, None where the log must be read to know.
    details
        What else the log says of it.
    """

    number: int
    topic: str
    type: str
    encoding: str
    schema_encoding: str = ""
    schema: bytes = b""
    count: int | None = None
    details: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True, slots=True)
class Extent:
    """When the first and the last message of a log came, in nanoseconds since 1970; None of a log without messages."""

    start_ns: int
    end_ns: int


def widened(extent: Extent | None, first_ns: int, last_ns: int) -> Extent:
    """The extent of a log in which messages of such times were found, too."""
    if extent is None:
        return Extent(first_ns, last_ns)
    return Extent(min(extent.start_ns, first_ns), max(extent.end_ns, last_ns))


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Some messages, in the order in which the log has them.

    Attributes
    ----------
    data : ndarray of uint8
        Bytes in which they lie.
    piece : int
        The piece of the log that they are of, or the first of those that they are of.
    """

    data: NDArray[np.uint8]
    rows: Rows
    piece: int = 0


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of a log that is read without the rest: a chunk, or records between chunks. Each message is in one piece.

    Attributes
    ----------
    size
        The bytes that it takes in the file.
    times
        Of its first and its last message; None where only reading it would tell.
    connections
        The numbers of those that have messages in it; None where only reading it would tell.
    """

    size: int
    times: tuple[int, int] | None = None
    connections: frozenset[int] | None = None

    def has(self, wanted: Wanted) -> bool:
        """Whether it may have messages that are wanted."""
        if self.times is not None and not wanted.overlaps(*self.times):
            return False
        return wanted.connections is None or self.connections is None or not wanted.connections.isdisjoint(self.connections)


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which messages are asked for. A reader may give more; it leaves out what costs it to read.

    Attributes
    ----------
    connections
        Their numbers; None for all.
    start_ns, end_ns
        From when on, and until before when; by the time at which they were logged.
    pieces
        The places of the pieces to read, of those that the reader has; None for all. Of these no others are given.
    """

    connections: frozenset[int] | None = None
    start_ns: int | None = None
    end_ns: int | None = None
    pieces: range | None = None

    def of(self, rows: Rows) -> Rows:
        """Those of some messages that are asked for; the same rows, if all are."""
        rows = rows if self.connections is None else rows.of_channels(self.connections)
        if self.start_ns is not None and not (kept := rows.log_ns >= self.start_ns).all():
            rows = rows.only(kept)
        if self.end_ns is not None and not (kept := rows.log_ns < self.end_ns).all():
            rows = rows.only(kept)
        return rows

    def overlaps(self, first_ns: int, last_ns: int) -> bool:
        """Whether a stretch of time has some that are wanted."""
        return (self.start_ns is None or last_ns >= self.start_ns) and (self.end_ns is None or first_ns < self.end_ns)


class Reader(Protocol):
    """An open log. What is wrong with it is told to ``tell`` when it is noticed, once each; what can be read is given nevertheless.

    A reader may also have ``works_ahead``, a bool: whether threads of its own work ahead while its blocks are used.
    """

    @property
    def connections(self) -> Mapping[int, Connection]:
        """Those that are known: those of the index, and more while blocks are read."""
        ...

    @property
    def extent(self) -> Extent | None: ...

    @property
    def facts(self) -> Mapping[str, str]:
        """What is to be known of the file: version, chunks, compression."""
        ...

    @property
    def pieces(self) -> Sequence[Piece]:
        """What can be read alone, in the order in which `blocks` reads it; one at least."""
        ...

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        """The messages. Several blocks are in use at a time, because they are read ahead (`rosetta_jit.logs.read_ahead`)."""
        ...


class Open(Protocol):
    """A function that opens a log."""

    def __call__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> Reader:
        """LogError where it is no such log at all; ``check`` asks to compare checksums."""
        ...


@dataclass(frozen=True, slots=True)
class Format:
    """A format of logs.

    Attributes
    ----------
    suffixes
        Of its files.
    magic
        How such files begin; empty where nothing tells.
    open
        An `Open`, as ``module:name``.
    folder
        For formats that are folders: a pattern of a file that such a folder has, or several patterns, of which one must fit.
    """

    name: str
    suffixes: tuple[str, ...]
    open: str
    magic: bytes = b""
    folder: str | tuple[str, ...] = ""

    def is_folder(self, path: Path) -> bool:
        """Whether a folder may be such a log."""
        patterns = (self.folder,) if isinstance(self.folder, str) else self.folder
        return any(next(path.glob(each), None) is not None for each in patterns if each)

    def opener(self) -> Open:
        """What opens it, imported when it is needed."""
        return cast("Open", object_at(self.open))
