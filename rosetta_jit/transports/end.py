"""The end of a channel: it counts what passes and what is lost, and is closed when its `with` block ends."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable
from types import TracebackType
from typing import TYPE_CHECKING, Self

from rosetta_jit.errors import TransportError
from rosetta_jit.terminal import printable
from rosetta_jit.transports.limits import MAX_ALIKE, MAX_REASON, MAX_REASONS

if TYPE_CHECKING:
    Lost = Callable[[str, int], object]


ALIKE_WORDS = 3
"""By which reasons are alike: `a message of …`. What a peer said stands behind them."""


class End:
    """One end of a channel: what passed there, and what did not.

    Attributes
    ----------
    messages, bytes : int
        Received, or taken to be sent.
    lost : Counter
        Messages that did not arrive or were not sent, by the reason in words.
    reconnects : int
        Connections that were made again.
    connections : int
        Peers that are connected now.
    sessions : int
        How often a peer came when there was none: 1 after the first one, 2 where all had gone and one came again.
    """

    def __init__(self, address: str, lost: Lost | None = None) -> None:
        self.address = address
        self.messages: int = 0
        self.bytes = 0
        self.lost: Counter[str] = Counter()
        self.reconnects = 0
        self.sessions = 0
        self._connections = 0
        self._tell = lost
        self._lock = threading.Lock()

    @property
    def connections(self) -> int:
        return self._connections

    @connections.setter
    def connections(self, count: int) -> None:
        self.sessions += count > 0 and not self._connections
        self._connections = count

    def passed(self, size: int) -> None:
        """Count a message of so many bytes; for transports."""
        self.messages += 1
        self.bytes += size

    def check_size(self, size: int, most: int) -> None:
        """TransportError where a message is larger than `max_message`; for transports."""
        if size > most:
            raise TransportError("too large", self.address, f"{size} bytes are more than max_message={most}")

    def lose_large(self, size: int, most: int) -> None:
        """Count a message that is lost because it is larger than `max_message`; for transports."""
        self.lose(f"a message of {size} bytes, more than max_message={most}")

    def lose(self, reason: str, count: int = 1) -> None:
        """Count messages that are lost, and say why; for transports. A reason may hold what a peer said."""
        reason = printable(reason[:MAX_REASON])
        with self._lock:
            if reason not in self.lost:
                reason = self._bounded(reason)
            self.lost[reason] += count
        if self._tell is not None:
            self._tell(reason, count)

    def _bounded(self, reason: str) -> str:
        """A new reason, or the one of all that begin alike: a peer that is wrong in ever new ways hides no other reasons."""
        head = " ".join(reason.split(" ", ALIKE_WORDS)[:ALIKE_WORDS])
        if sum(each.startswith(head) for each in self.lost) >= MAX_ALIKE:
            reason = f"{head} …"
        return reason if reason in self.lost or len(self.lost) < MAX_REASONS else "other reasons"

    def close(self) -> None:
        """Stop."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


def not_open() -> None:
    """How an end is closed that nothing has opened yet, or that is closed already."""
