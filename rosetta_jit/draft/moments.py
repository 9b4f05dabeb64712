"""Moments: one number of a unit on one side, seconds and nanoseconds on the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.draft.conversions import as_type
from rosetta_jit.draft.words import shared, tokens
from rosetta_jit.language.typed import INT64
from rosetta_jit.language.units.dimensions import conversion
from rosetta_jit.model.types import Float, Int

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.draft.leaves import Leaf

SECONDS = frozenset(("sec", "second"))
NANOSECONDS = frozenset(("nsec", "nanosec", "nanosecond"))
MOMENTS = frozenset(("time", "timestamp", "stamp", "date", "duration", "moment"))

ALIKE = 0.8
"""How much of two names is shared where they are of the same moment."""

Clock = tuple["Leaf", "Leaf"]
"""Seconds, and the nanoseconds behind them."""


def clocks(leaves: list[Leaf]) -> list[Clock]:
    """The messages that are a moment."""
    seconds = [each for each in leaves if SECONDS & {*tokens(each.names[-1])} and isinstance(each.type, Int)]
    rest = {each.group: each for each in leaves if NANOSECONDS & {*tokens(each.names[-1])} and isinstance(each.type, Int)}
    return [(each, rest[each.group]) for each in seconds if each.group in rest]


def without_another(mine: list[Clock], theirs: list[Clock]) -> list[Clock]:
    """The clocks that are not the same moment as one of the other side: that one tells them better than a number does."""
    return [each for each in mine if not any(shared(each[0].names[:-1], other[0].names[:-1]) > ALIKE for other in theirs)]


def numbers(leaves: list[Leaf]) -> Iterator[Leaf]:
    """The numbers that are a moment, by their name or their message's, and by their unit."""
    for each in leaves:
        said = {*tokens(each.names[-1]), *tokens(each.types[-1].replace("/", ".").split(".")[-1])}
        if said & MOMENTS and isinstance(each.type, Int | Float) and each.unit is not None and _a_second(each.unit) is not None:
            yield each


def _a_second(unit: str) -> int | None:
    """How many of a unit are a second, where that is a power of 1000."""
    found = conversion("s", unit)
    if found is None or isinstance(found, str) or found[1]:
        return None
    return round(found[0]) if round(found[0]) in {1, 10**3, 10**6, 10**9} else None


def best_clock(number: Leaf, known: list[Clock]) -> Clock | None:
    """The clock that a number is likely the same moment as."""
    fitting = [each for each in known if each[0].depth == number.depth]
    words = (*number.names, *number.types)
    return max(fitting, key=lambda each: (shared(each[0].names[:-1], words), -len(each[0].names)), default=None)


def of_clock(number: Leaf, clock: Clock, index: str) -> str | None:
    """A number as a clock tells it."""
    seconds, rest = (each.path(index) for each in clock)
    each_second = _a_second(number.unit or "")
    match number.type, each_second:
        case Float(), 1:
            return as_type(number.type, Float(64), f"timestamp({seconds}, {rest})")
        case Int(), 1_000_000_000:
            return as_type(number.type, INT64, f"nanoseconds({seconds}, {rest})")
        case Int(), int(units) if units > 1:
            return as_type(number.type, INT64, f"{seconds} * {units} + floor_divide({rest}, {1_000_000_000 // units})")
        case _:
            return None


def of_number(number: Leaf, clock: Clock, index: str) -> tuple[str, str] | None:
    """The seconds and the nanoseconds of a clock as a number tells them."""
    value, each_second = number.path(index), _a_second(number.unit or "")
    match number.type, each_second:
        case (Float(), 1) | (Int(), 1_000_000_000):
            texts = (f"seconds({value})", f"fraction({value})")
            if isinstance(number.type, Int):
                texts = (f"floor_divide({value}, 1000000000)", f"modulo({value}, 1000000000)")
        case Int(), int(units) if units > 1:
            texts = (f"floor_divide({value}, {units})", f"modulo({value}, {units}) * {1_000_000_000 // units}")
        case _:
            return None
    seconds, rest = (as_type(leaf.type, INT64, text) for leaf, text in zip(clock, texts, strict=True))
    return None if seconds is None or rest is None else (seconds, rest)
