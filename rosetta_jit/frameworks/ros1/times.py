"""What genpy's Time and Duration can do besides having ``secs`` and ``nsecs``."""

from __future__ import annotations

from typing import Any

NANO = 1_000_000_000


def to_nsec(self: Any) -> int:
    """Nanoseconds."""
    return self.secs * NANO + self.nsecs


def to_sec(self: Any) -> float:
    """Seconds, as a float."""
    return self.secs + self.nsecs / NANO


def set_nsec(self: Any, nanoseconds: int) -> Any:
    """Become so many nanoseconds; returns itself."""
    self.secs, self.nsecs = divmod(nanoseconds, NANO)
    return self


def is_zero(self: Any) -> bool:
    """Whether it is no time at all."""
    return not (self.secs or self.nsecs)


def _less(self: Any, other: Any) -> bool:
    return to_nsec(self) < to_nsec(other)


def _at_most(self: Any, other: Any) -> bool:
    return to_nsec(self) <= to_nsec(other)


SHARED: dict[str, Any] = {
    "to_sec": to_sec,
    "to_nsec": to_nsec,
    "set_nsec": set_nsec,
    "is_zero": is_zero,
    "__float__": to_sec,
    "__lt__": _less,
    "__le__": _at_most,
}
TIME = {**SHARED, "to_time": to_sec}
DURATION = SHARED
