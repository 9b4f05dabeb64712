"""Masks of integers: which bits they have."""

from __future__ import annotations

MOST_BITS = 62
"""The largest power of two that is an int64."""


def lowest_of_run(mask: int) -> int | None:
    """The number of the lowest bit of a mask whose bits are neighbours; None of other masks."""
    if not 0 < mask < 1 << MOST_BITS:
        return None
    shift = (mask & -mask).bit_length() - 1
    return None if (mask >> shift) & ((mask >> shift) + 1) else shift
