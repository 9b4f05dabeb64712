"""Messages of several topics as a folder of tables, by topic and time. A conversion that was killed goes on where it was.

The log is read once. Whenever so many bytes of messages are done, the files that are open are finished, and the journal says so: see
`rosetta_jit.logs.converting.journal`. After a kill, what the journal does not mention is removed and made again.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.logs.base import Block, Wanted
from rosetta_jit.logs.converting.journal import NAME, PART, Journal, Progress
from rosetta_jit.logs.converting.parts import Parts
from rosetta_jit.logs.converting.rejected import Damaged, Rejected
from rosetta_jit.logs.decoded_parts import CLOCKS, LARGE_BYTES, Collector, Part
from rosetta_jit.logs.folder_names import folder_names
from rosetta_jit.logs.tables import table_of
from rosetta_jit.startup.dataclass import dataclass, field, replace

if TYPE_CHECKING:
    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.log import Log

STEP_BYTES = 256 << 20
"""Messages between one writing of the journal and the next."""

WAITING_BYTES = 16 << 20
"""Messages that wait to become tables, of all topics together."""

QUARANTINE = "_quarantine.jsonl"


@dataclass(frozen=True, slots=True, eq=False)
class _Stream:
    """Messages of one topic and type, the folder of their tables, and those that wait to become a table."""

    channel: Channel
    label: str
    name: str
    collector: Collector


@dataclass(slots=True)
class FolderConversion:
    """Messages of a log on their way into a folder.

    Attributes
    ----------
    suffix
        Of the tables: ``.parquet``, ``.arrow`` or ``.csv``.
    every_ns
        The stretch of time of a folder.
    start, end
        From when on, and until before when; nanoseconds since 1970.
    options
        Of the tables: ``columns``, ``flatten``, ``clocks``, as `Channel.to_arrow` takes them.
    resume
        Whether to go on where a conversion stopped.
    advance
        Is told how many messages were read, those that were read before included.
    """

    log: Log
    channels: list[Channel]
    output: Path
    suffix: str = ".parquet"
    every_ns: int = 3600 * 10**9
    start: int | None = None
    end: int | None = None
    on_error: Damaged = "stop"
    options: dict[str, Any] = field(default_factory=dict[str, Any])
    resume: bool = False
    step_bytes: int = STEP_BYTES
    advance: Callable[[int], object] = int

    def run(self) -> Rejected:
        """Write the folder; gives what was left out, now and before.

        Raises
        ------
        LogError
            The folder is not empty, or of another conversion.
        DecodeError
            A message is not what its type promises, and ``on_error`` is to stop. What was done before is kept.
        """
        journal = Journal(self.output, self._request())
        self._check_empty()
        progress = journal.read() if self.resume else Progress()
        rejected = Rejected(self.output / QUARANTINE, self.on_error, dict(progress.rejected))
        self.advance(sum(progress.seen.values()))
        if progress.is_complete:
            return rejected
        for each in self.channels:
            each.decoder  # noqa: B018 - what is wrong with a type is said before anything is written
        self.output.mkdir(parents=True, exist_ok=True)
        rejected.begin(progress.rejected_bytes)
        journal.write(progress)
        parts = Parts(self.output, self.suffix, self.every_ns, progress.number)
        parts.remove_unfinished()
        try:
            self._convert(journal, progress, parts, rejected)
        finally:
            parts.abandon()
            rejected.close()
        return rejected

    def _request(self) -> dict[str, Any]:
        """What makes one conversion another, as JSON has it."""
        path, pieces = Path(self.log.name), self.log.pieces
        return {
            "log": str(path.resolve()) if path.exists() else self.log.name,
            "pieces": [len(pieces), sum(each.size for each in pieces)],
            "topics": [[each.topic, each.type, each.target or "", sorted(each.numbers)] for each in self.channels],
            "stretch": self.every_ns,
            "format": self.suffix,
            "start": self.start,
            "end": self.end,
            "options": json.loads(json.dumps(self.options, sort_keys=True)),
        }

    def _check_empty(self) -> None:
        output = self.output
        there = {each.name for each in output.iterdir()} if output.is_dir() else {output.name} if output.exists() else set[str]()
        if there - {PART} and not (self.resume and NAME in there):
            raise LogError((words.not_empty(str(output)),))

    def _convert(self, journal: Journal, progress: Progress, parts: Parts, rejected: Rejected) -> None:
        labels, room = _labels(self.channels), min(LARGE_BYTES, WAITING_BYTES // max(len(self.channels), 1))
        names, streams = folder_names(labels), list[_Stream]()
        for label, each in zip(labels, self.channels, strict=True):
            first = progress.seen.get(label, 0)
            collector = Collector(each.decoder, rejected.on_error, first=first, size=room, expected=each.count)
            streams.append(_Stream(each, label, names[label], collector))
        done = 0
        for piece, within, block in self._blocks(progress):
            for stream in streams:
                rows = block.rows.of_channels(stream.channel.numbers)
                self._add(stream, stream.collector.put(block, rows), progress, parts, rejected)
            done += int((block.rows.ends - block.rows.begins).sum())
            progress.piece, progress.within = piece, within
            self.advance(len(block.rows))
            if done >= self.step_bytes or parts.is_full:
                self._step(streams, journal, progress, parts, rejected)
                done = 0
        progress.is_complete = True
        self._step(streams, journal, progress, parts, rejected)

    def _blocks(self, progress: Progress) -> Iterator[tuple[int, int, Block]]:
        """The messages that are left, with the piece and the number of messages in it that are done behind each block."""
        numbers = frozenset(number for each in self.channels for number in each.numbers)
        first, skipped = progress.piece, progress.within
        piece, within = first, 0
        for block in self.log.blocks_ahead(Wanted(numbers, self.start, self.end, range(first, len(self.log.pieces)))):
            if block.piece != piece:
                piece, within = block.piece, 0
            before, within = within, within + len(block.rows)
            done = skipped - before if piece == first else 0
            if done < len(block.rows):
                yield piece, within, replace(block, rows=block.rows.only(slice(max(done, 0), None)))

    def _step(self, streams: list[_Stream], journal: Journal, progress: Progress, parts: Parts, rejected: Rejected) -> None:
        """Finish all files, and say so in the journal."""
        for stream in streams:
            self._add(stream, stream.collector.rest(), progress, parts, rejected)
        parts.finish()
        progress.number, progress.rejected, progress.rejected_bytes = parts.number, dict(rejected.counts), rejected.kept()
        journal.write(progress)

    def _add(self, stream: _Stream, found: Iterable[Part], progress: Progress, parts: Parts, rejected: Rejected) -> None:
        """Write decoded messages as tables."""
        options = dict(self.options)
        columns, clocks = options.pop("columns", None), options.pop("clocks", CLOCKS)
        for part in found:
            rejected.add(stream.channel.topic, part.first, part.batch.errors, part.refused)
            if len(part.log_ns):
                parts.add(stream.name, table_of(part, columns, clocks, options), part.log_ns)
            progress.seen[stream.label] = part.first + part.given


def _labels(channels: Sequence[Channel]) -> list[str]:
    """What the tables of each channel are called: by the topic, and by the type too where a topic has several."""
    several = Counter(each.topic for each in channels)
    labels, taken = list[str](), Counter[str]()
    for each in channels:
        label = each.topic if several[each.topic] == 1 else f"{each.topic}.{each.type}"
        taken[label] += 1
        labels.append(label if taken[label] == 1 else f"{label}.{taken[label]}")
    return labels
