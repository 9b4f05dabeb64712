"""What passed a route, what did not and why, and how long it took."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Sequence
from operator import add
from time import monotonic
from typing import Any

from rosetta_jit.bridge.limits import MAX_CAUSES

OTHERS = "other causes"
SUB = 8
"""Parts that each power of two of nanoseconds is divided into: latencies are known to an eighth."""


WINDOW_S = 60.0
"""Quantiles are of the latencies of one to two such times: of what happens now, not of all since the start."""


class Latencies:
    """How often which latency was measured in the present window, and in the one before.

    Attributes
    ----------
    total, total_ns : int
        All since the start: how many, and their sum in nanoseconds.
    """

    __slots__ = ("_before", "_begun", "_counts", "total", "total_ns")

    def __init__(self) -> None:
        self._before: Sequence[int] = _NONE
        self._counts = [*_NONE]
        self._begun = monotonic()
        self.total = self.total_ns = 0

    def forget(self, now: float) -> None:
        """Begin another window where the present one is over; the moment is that of the monotonic clock."""
        if now >= self._begun + WINDOW_S:
            self._before = self._counts if now < self._begun + 2 * WINDOW_S else _NONE
            self._counts, self._begun = [*_NONE], now

    def add(self, nanoseconds: int) -> None:
        """One more."""
        power = nanoseconds.bit_length()
        self._counts[power * SUB + (nanoseconds >> power - 4 & 7) if power > 3 else nanoseconds] += 1
        self.total += 1
        self.total_ns += nanoseconds

    def quantile(self, part: float) -> int | None:
        """The latency that so many are not above, in nanoseconds; None where there are none."""
        counts = [*map(add, self._before, self._counts)]
        left = sum(counts) * part
        for number, count in enumerate(counts):
            left -= count
            if count and left <= 0:
                power, rest = divmod(number, SUB)
                return number if power <= 3 else (SUB + rest + 1) << power - 4
        return None


_NONE = (0,) * (64 * SUB)


class RouteCounts:
    """The counts of one route.

    Attributes
    ----------
    taken, sent : int
        Messages that came, and that went.
    bytes_in, bytes_out : int
        Their bytes.
    dropped : Counter
        Messages that did not go on, by reason: a rate, a full queue, what the target's transport says.
    failed : Counter
        Messages that could not be translated or answered, by cause.
    """

    def __init__(self) -> None:
        self.taken = self.sent = self.bytes_in = self.bytes_out = 0
        self.dropped: Counter[str] = Counter()
        self.failed: Counter[str] = Counter()
        self.latencies = Latencies()
        self._lock = threading.Lock()
        self._before = (monotonic(), 0, 0, 0)

    def passed(self, size: int, nanoseconds: int) -> None:
        """Count a message that went, and how long it took from its arrival."""
        self.sent += 1
        self.bytes_out += size
        self.latencies.add(nanoseconds)

    def drop(self, reason: str, count: int = 1) -> bool:
        """Count messages that do not go on; whether this is worth a line, as it is at the first, the tenth, the hundredth …"""
        return self._count(self.dropped, reason, count)

    def lose(self, reason: str, count: int) -> str:
        """Count as `drop`; the line that says so, empty where it is not worth one. A count of 0: a peer was refused, and tries again."""
        if not count:
            return reason if reason not in self.dropped and self.drop(reason, 0) else ""
        return f"{self.dropped[reason] or 'many'} dropped: {reason}" if self.drop(reason, count) else ""

    def fail(self, cause: str) -> bool:
        """Count a message that could not be translated; as `drop`."""
        return self._count(self.failed, cause, 1)

    def _count(self, counter: Counter[str], cause: str, count: int) -> bool:
        with self._lock:
            known = cause if cause in counter or len(counter) < MAX_CAUSES else OTHERS
            before = counter[known]
            counter[known] += count
            return len(str(before)) < len(str(before + count)) or not before

    def snapshot(self) -> dict[str, Any]:
        """All of it as plain data, and the rates since the last snapshot."""
        now, then = (monotonic(), self.taken, self.sent, self.bytes_out), self._before
        self._before = now
        seconds = max(now[0] - then[0], 1e-6)
        self.latencies.forget(now[0])
        with self._lock:
            dropped, failed = dict(self.dropped), dict(self.failed)
        return {
            "taken": self.taken,
            "sent": self.sent,
            "bytes_in": self.bytes_in,
            "bytes_out": self.bytes_out,
            "taken_per_s": (now[1] - then[1]) / seconds,
            "sent_per_s": (now[2] - then[2]) / seconds,
            "bytes_per_s": (now[3] - then[3]) / seconds,
            "p50_us": _microseconds(self.latencies.quantile(0.5)),
            "p99_us": _microseconds(self.latencies.quantile(0.99)),
            "latencies": self.latencies.total,
            "latencies_s": self.latencies.total_ns / 1e9,
            "dropped": dropped,
            "failed": failed,
        }


def _microseconds(nanoseconds: int | None) -> float | None:
    return None if nanoseconds is None else nanoseconds / 1000
