"""A log as bytes: its streams, what is wrong with it, and blocks of its messages."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Self

from rosetta_jit.logs.base import Block, Connection, Format, Piece, Reader, Wanted
from rosetta_jit.logs.read_ahead import ahead

if TYPE_CHECKING:
    from rosetta_jit.api.options import Options
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.logs.reading.storage import Storage


class LogFile:
    """A log, of which nothing but the index is read when it is opened.

    Attributes
    ----------
    name : str
    format : str
        ``mcap``, ``bag``, ``lcm``, …
    problems : list of Diagnostic
        What has been noticed to be wrong with the file so far.
    """

    def __init__(
        self, storage: Storage, form: Format, on_problem: Callable[[Diagnostic], object], *, check: bool, options: Options
    ) -> None:
        self.name, self.format = storage.name, form.name
        self.problems: list[Diagnostic] = []
        self._on_problem, self._options, self._check = on_problem, options, check
        self._storage = storage
        self._reader: Reader = form.opener()(storage, self._tell, check=check)

    def _tell(self, problem: Diagnostic) -> None:
        if problem not in self.problems:
            self.problems.append(problem)
            self._on_problem(problem)

    @property
    def path(self) -> Path:
        return Path(self.name)

    @property
    def connections(self) -> tuple[Connection, ...]:
        """The streams of messages, as the log has them: a bag has one for each publisher."""
        return tuple(self._reader.connections.values())

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics, sorted."""
        return tuple(sorted({each.topic for each in self.connections}))

    @property
    def start(self) -> int | None:
        """When the first message was logged, in nanoseconds since 1970; None of a log without messages.

        None, too, of an MCAP file with an index where a chunk has messages before 1970 and behind: then only reading would tell.
        """
        return None if self._reader.extent is None else self._reader.extent.start_ns

    @property
    def end(self) -> int | None:
        """When the last one was."""
        return None if self._reader.extent is None else self._reader.extent.end_ns

    @property
    def facts(self) -> dict[str, str]:
        """What else the file tells: its version, chunks and compression."""
        return dict(self._reader.facts)

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """The stretches of the log that can be read alone, of which each message is in one: the chunks, where it has any."""
        return tuple(self._reader.pieces)

    def blocks(self, wanted: Wanted | None = None) -> Iterator[Block]:
        """The messages as bytes, many at a time, in the order in which they lie."""
        wanted = wanted or Wanted()
        if wanted.pieces is not None and not wanted.pieces:
            return
        for block in self._reader.blocks(wanted):
            rows = wanted.of(block.rows)
            if rows is block.rows:
                yield block
            elif len(rows):
                yield type(block)(block.data, rows, block.piece)

    def blocks_ahead(self, wanted: Wanted | None = None) -> Iterator[Block]:
        """The same; while a block is used, threads read and decompress the next ones."""
        blocks = self.blocks(wanted)
        return blocks if getattr(self._reader, "works_ahead", False) else ahead(blocks, lambda each: each.data.size)

    def close(self) -> None:
        """Close the file."""
        self._storage.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
