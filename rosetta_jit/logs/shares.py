"""A topic of many logs in shares, each of which a task of an engine reads: a whole log, or some pieces of a large one.

A share is a recipe of some hundred bytes. Whoever has it, and the logs at the same paths, opens the log and makes a decoder of its own,
from the cache of compiled kernels where one is there.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from rosetta_jit.errors import LogError
from rosetta_jit.logs.base import Piece, Wanted
from rosetta_jit.logs.channel import Channel
from rosetta_jit.logs.decoded_parts import CLOCKS
from rosetta_jit.logs.log import open_log
from rosetta_jit.logs.moments import nanoseconds
from rosetta_jit.startup.dataclass import dataclass, field, replace

if TYPE_CHECKING:
    import pyarrow as pa

    from rosetta_jit.logs.moments import Moment

ALL_CLOCKS = (*CLOCKS, "header_time")
LEAST_BYTES = 4 << 20
"""What a share has at least, of a log that is taken apart: opening it again takes as long as reading that much."""


@dataclass(frozen=True, slots=True)
class Reading:
    """What is read of each log.

    Attributes
    ----------
    topic
        Its topic.
    target
        A mapping, or the name of the type; None for the log's own type.
    names
        The columns, in order, those of times among them; None for all fields behind ``clocks``.
    form
        What else `Channel.to_arrow` takes: ``flatten``, ``octets``, ``times``.
    start_ns, end_ns
        From when on, and until before when.
    on_error
        Of messages that cannot be decoded: ``raise`` or ``skip``.
    on_missing
        Of logs without the topic: ``raise`` or ``skip``.
    options
        Of the decoder.
    """

    topic: str
    target: str | None = None
    names: tuple[str, ...] | None = None
    clocks: tuple[str, ...] = CLOCKS
    form: Mapping[str, Any] = field(default_factory=dict[str, Any])
    start_ns: int | None = None
    end_ns: int | None = None
    on_error: Literal["raise", "skip"] = "raise"
    on_missing: Literal["raise", "skip"] = "raise"
    options: Mapping[str, Any] = field(default_factory=dict[str, Any])

    @classmethod
    def of(
        cls,
        topic: str,
        mapping: str | os.PathLike[str] | None,
        columns: Iterable[str] | None,
        clocks: Iterable[str],
        start: Moment | None,
        end: Moment | None,
        **options: Any,
    ) -> Reading:
        """What a user says. ``columns`` are fields; ``clocks`` come before them."""
        chosen = tuple(clocks)
        names = None if columns is None else (*chosen, *columns)
        target = None if mapping is None else str(mapping)
        return cls(topic, target, names, chosen, start_ns=nanoseconds(start), end_ns=nanoseconds(end), **options)

    def channel(self, path: str) -> Channel:
        """The topic of a log, which is opened; LogError where it has none."""
        log = open_log(path, **self.options)
        return log.channel(self.topic, self.target)

    def wanted(self, channel: Channel) -> Wanted:
        """The messages that are asked for."""
        return Wanted(channel.numbers, self.start_ns, self.end_ns)

    def schema(self, paths: Iterable[str]) -> pa.Schema:
        """The columns of all tables, by the definition of the type in the first log that has the topic; no message is read.

        Raises
        ------
        LogError
            No log has it.
        """
        path = ""
        for path in paths:
            for table in self.tables(path, range(0)):
                return table.schema
        return next(replace(self, on_missing="raise").tables(path, range(0))).schema

    def tables(self, path: str, pieces: range | None) -> Iterator[pa.Table]:
        """The tables of a log, or of some of its pieces; one at least, but of a log without the topic none, if that is not to raise."""
        try:
            channel = self.channel(path)
        except LogError as error:
            if self.on_missing == "raise" or [each.code for each in error.diagnostics] != ["log-topic"]:
                raise
            return
        fields, clocks = None, self.clocks
        if self.names is not None:
            fields = [each for each in self.names if each not in ALL_CLOCKS]
            clocks = tuple(each for each in self.names if each in ALL_CLOCKS)
        options = {"clocks": clocks, "start": self.start_ns, "end": self.end_ns, "on_error": self.on_error, **self.form}
        for table in channel.tables(fields, pieces=pieces, **options):
            yield table if self.names is None else table.select(list(_in_order(self.names, table.schema.names)))


def _in_order(names: Iterable[str], there: Sequence[str]) -> Iterator[str]:
    """The columns of a table in the order of some names, of which each may have become several columns."""
    for name in names:
        yield from (each for each in there if each == name or each.startswith(f"{name}."))


@dataclass(frozen=True, slots=True)
class Share:
    """What one task reads.

    Attributes
    ----------
    path
        The log.
    pieces
        The places of its pieces; None for all.
    size
        The bytes that they take in the file, None where nobody has looked.
    rows
        How many messages they have, None where that is not known.
    """

    path: str
    pieces: range | None = None
    size: int | None = None
    rows: int | None = None

    def tables(self, reading: Reading) -> Iterator[pa.Table]:
        """The messages."""
        return reading.tables(self.path, self.pieces)


def shares_of(paths: Sequence[str], reading: Reading, tasks: int) -> list[Share]:
    """At least so many shares, if the logs have as many pieces. With as many logs as tasks, each log is one, and none is opened.

    A log is not taken apart where the mapping keeps state: what a message becomes depends on all before it.
    """
    if len(paths) >= tasks:
        return [Share(each) for each in paths]
    found = [(path, *_pieces(path, reading)) for path in paths]
    total = sum(each.size for _, pieces, _ in found for each in pieces.values())
    room = max(total // max(tasks, 1), LEAST_BYTES)
    shares = [share for path, pieces, rows in found for share in _split(path, pieces, rows, room)]
    return [Share(each) for each in dict.fromkeys(share.path for share in shares)] if _keeps_state(shares, reading) else shares


def _keeps_state(shares: Sequence[Share], reading: Reading) -> bool:
    """Whether what a message becomes depends on those before it."""
    by_mapping = reading.target is not None and reading.target.endswith(".mapping")
    return by_mapping and bool(shares) and bool(reading.channel(shares[0].path).decoder.state)


def _pieces(path: str, reading: Reading) -> tuple[dict[int, Piece], int | None]:
    """The pieces of a log that may have what is wanted, by their places, and how many messages all have, if that is known."""
    try:
        channel = reading.channel(path)
    except LogError:
        if reading.on_missing == "raise":
            raise
        return {}, 0
    wanted = reading.wanted(channel)
    found = {place: each for place, each in enumerate(channel.log.pieces) if each.has(wanted)}
    whole = reading.start_ns is None and reading.end_ns is None and reading.on_error == "raise"
    return found, channel.count if whole else None


def _split(path: str, pieces: Mapping[int, Piece], rows: int | None, room: int) -> Iterator[Share]:
    """Pieces that lie together, until they take up the room of a share."""
    waiting: list[int] = []
    size = 0
    for place in pieces:
        if waiting and (size >= room or place != waiting[-1] + 1):
            yield Share(path, range(waiting[0], waiting[-1] + 1), size)
            waiting, size = [], 0
        waiting.append(place)
        size += pieces[place].size
    if waiting:
        last = Share(path, range(waiting[0], waiting[-1] + 1), size)
        yield replace(last, rows=rows) if waiting[0] == min(pieces) else last


def paths_of(paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]]) -> list[str]:
    """The paths of logs; one with ``*`` or ``?`` stands for all that it matches, in order of their names.

    Raises
    ------
    FileNotFoundError
        Nothing matches.
    """
    import os
    from glob import glob, has_magic

    names = [os.fspath(paths)] if isinstance(paths, str | os.PathLike) else [os.fspath(each) for each in paths]
    found: list[str] = []
    for each in names:
        if has_magic(each) and not os.path.exists(each):  # noqa: PTH110 - it may be a URL
            found += _matching(each) if "://" in each else sorted(glob(each))  # noqa: PTH207 - the same
        else:
            found.append(each)
    if not found:
        raise FileNotFoundError(f"there are no logs {', '.join(names)}")
    return found


def _matching(url: str) -> list[str]:
    from importlib import import_module

    fsspec: Any = import_module("fsspec")
    system, path = fsspec.core.url_to_fs(url)
    return sorted(system.unstrip_protocol(each) for each in system.glob(path))
