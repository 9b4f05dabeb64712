"""Moments of logs: nanoseconds since 1970, and what a person writes for them."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np

if TYPE_CHECKING:
    Moment: TypeAlias = int | datetime | np.datetime64
else:
    Moment = object

MOST_DIGITS = 11
"""Digits of seconds since 1970 at most. Milliseconds and nanoseconds of today have more, and would be taken for a time that never comes."""

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def nanoseconds(moment: Moment | None) -> int | None:
    """Nanoseconds since 1970. A `datetime` without a zone is in UTC; one of pandas has nanoseconds.

    Raises
    ------
    TypeError
        It is a float, which has no room for nanoseconds, or nothing of time.
    ValueError
        It is no time (``NaT``).
    """
    match moment:
        case None:
            return None
        case np.datetime64() | datetime() if moment != moment:  # noqa: PLR0124 - as NaT is not itself
            raise ValueError("NaT is no moment")
        case np.datetime64():
            return int(moment.astype("datetime64[ns]").astype(np.int64))
        case datetime():
            since = (moment if moment.tzinfo is not None else moment.replace(tzinfo=UTC)) - _EPOCH
            return int(since // timedelta(microseconds=1)) * 1000 + int(getattr(moment, "nanosecond", 0))
        case _:
            return _integer(moment)


def _integer(moment: object) -> int:
    if isinstance(moment, int | np.integer):
        return int(cast("int", moment))
    raise TypeError(f"a moment is an int of nanoseconds, a datetime or a numpy.datetime64, not {type(moment).__name__}")


def shown(time_ns: int) -> str:
    """A moment as ISO 8601 with nanoseconds; one that is out of range, as damaged logs have them, as it is."""
    if not -(1 << 63) < time_ns < 1 << 63:
        return f"{time_ns} ns"
    return f"{np.datetime64(time_ns, 'ns')}Z"


def moment_of(text: str) -> int:
    """A moment as a person writes it: seconds since 1970, or ISO 8601; ValueError if it is neither, or too far to be meant.

    Digits are read as they are: a float has no room for nanoseconds, and `datetime` has none.
    """
    seconds, _, fraction = text.replace(",", ".").partition(".")
    digits = seconds.removeprefix("-")
    if digits.isdigit() and len(digits) > MOST_DIGITS:
        raise ValueError(f"{text} s is beyond the year 5138: seconds since 1970 are meant, not a part of them")
    if digits.isdigit() and (fraction.isdigit() or not fraction):
        size = int(digits) * 10**9 + _nanoseconds_of(fraction)
        return -size if seconds.startswith("-") else size
    whole = nanoseconds(datetime.fromisoformat(text)) or 0
    return whole + _nanoseconds_of(fraction) % 1000


def _nanoseconds_of(fraction: str) -> int:
    """The digits behind a point, up to what follows them, as nanoseconds."""
    digits = fraction[: len(fraction) - len(fraction.lstrip("0123456789"))]
    return int(digits[:9].ljust(9, "0"))
