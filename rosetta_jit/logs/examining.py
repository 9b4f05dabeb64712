"""What is wrong with a log, found by reading and decoding all of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import LogError, ReportError
from rosetta_jit.startup.dataclass import dataclass, field, replace

if TYPE_CHECKING:
    from rosetta_jit.logs.base import Block
    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.log import Log


@dataclass(slots=True)
class Seen:
    """What was seen of one stream of messages."""

    count: int = 0
    last_ns: int | None = None
    early: int = 0
    undecodable: int = 0
    first_error: tuple[int, str] | None = None


@dataclass(slots=True)
class Examination:
    """A log that is being examined."""

    log: Log
    decode: bool = True
    seen: dict[int, Seen] = field(default_factory=dict[int, Seen])
    channels: dict[int, Channel | None] = field(default_factory=dict["int", "Channel | None"])
    reports: list[Diagnostic] = field(default_factory=list["Diagnostic"])

    def run(self, advance: Callable[[int], object] = int) -> list[Diagnostic]:
        """Read everything; ``advance`` is told how many messages were read."""
        for block in self.log.blocks():
            for number in np.unique(block.rows.channels).tolist():
                self._messages(block, number)
            advance(len(block.rows))
        return [*self.log.problems, *self.reports, *self._findings()]

    def _messages(self, block: Block, number: int) -> None:
        rows = block.rows.only(block.rows.channels == number)
        seen = self.seen.setdefault(number, Seen())
        times = rows.log_ns if seen.last_ns is None else np.append(seen.last_ns, rows.log_ns)
        seen.early += int((np.diff(times) < 0).sum())
        channel = self._channel(number)
        if channel is not None and self.decode:
            errors = channel.decoded(block, rows, "skip").errors
            seen.undecodable += len(errors)
            if errors and seen.first_error is None:
                index, error = next(iter(errors.items()))
                seen.first_error = seen.count + index, str(error)
        seen.count += len(rows)
        seen.last_ns = int(rows.log_ns[-1])

    def _channel(self, number: int) -> Channel | None:
        """The channel of a stream, if its messages can be decoded; why they cannot is reported once."""
        if number not in self.channels:
            channel = next((each for each in self.log.channels if any(one.number == number for one in each.connections)), None)
            self.channels[number] = channel
            try:
                if channel is not None and self.decode:
                    channel.decoder  # noqa: B018 - it is made now
            except ReportError as error:
                self.reports += error.diagnostics
                self.channels[number] = None
        return self.channels[number]

    def _findings(self) -> list[Diagnostic]:
        name, found = self.log.name, list["Diagnostic"]()
        known = {each.number: each for each in self.log.connections}
        for number, seen in self.seen.items():
            if number not in known:
                found.append(words.unknown_channel(name, number))
                continue
            topic, promised = known[number].topic, known[number].count
            if promised is not None and promised != seen.count:
                found.append(words.miscounted(name, topic, promised, seen.count))
            if seen.early:
                found.append(words.out_of_order(name, topic, seen.early))
            if seen.first_error is not None:
                found.append(words.undecodable(name, topic, *seen.first_error, seen.undecodable))
        for topic in self.log.topics:
            try:
                self.log.channel(topic)
            except LogError as error:  # it has several types
                found += [replace(each, severity="warning") for each in error.diagnostics]
        unread = [each for number, each in known.items() if number not in self.seen and each.count]
        found += [words.miscounted(name, each.topic, each.count or 0, 0) for each in unread]
        return found
