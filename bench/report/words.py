"""Numbers as people read them: nanoseconds in the unit that suits, ratios in three digits, medians with their quartiles."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bench.figures import Spread

LOOPS = 0.02
"""The part of a ratio from which on it is shown what the loops make of it."""

_TIMES = ((1e9, "s"), (1e6, "ms"), (1e3, "µs"), (1.0, "ns"))


def time(nanoseconds: float) -> str:
    """`1.23 µs`."""
    size, unit = next(((size, unit) for size, unit in _TIMES if nanoseconds >= size), _TIMES[-1])
    return f"{number(nanoseconds / size)} {unit}"


def spread_of_time(took: Spread) -> str:
    """`1.23 µs (1.20 to 1.31)`: quartiles in the median's unit."""
    size, unit = next(((size, unit) for size, unit in _TIMES if took.median >= size), _TIMES[-1])
    return f"{number(took.median / size)} {unit} ({number(took.low / size)} to {number(took.high / size)})"


def ratio(value: Spread) -> str:
    """`1.23 (1.20 to 1.31)`; with `, 1.4 net` where the loops around both make a difference."""
    found = f"{number(value.median)} ({number(value.low)} to {number(value.high)})"
    differs = value.net is not None and abs(value.net - value.median) > LOOPS * value.median
    return f"{found}, {number(value.net or 0.0)} net" if differs else found


def messages(different: int | None) -> str:
    """How many different messages came in turn."""
    if different is None:
        return ""
    return "one message, repeated" if different == 1 else f"{different:,} messages in turn"


def count(value: float) -> str:
    """A number on an axis: `8`, `1k`, `16M`."""
    for size, unit in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if value >= size:
            return f"{value / size:.3g}{unit}"
    return f"{value:.3g}"


def number(value: float) -> str:
    """Three digits, never an exponent."""
    if value >= 100:
        return f"{value:.0f}"
    return f"{value:.3g}"
