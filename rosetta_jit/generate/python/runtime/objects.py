"""Objects, and rows that become objects."""

# pyright: reportUnusedFunction=false, reportPrivateUsage=false

from __future__ import annotations

from typing import Any

from rosetta_jit.generate.python.runtime.errors import _Failed

_ZERO = 0
_ZERO_FLOAT = 0.0
"""What numbers are that nobody has set: the same objects as defaults, so that it takes no call to see that."""

_NOTHING = bytearray()
"""Rows of lanes that have no room yet."""

_new = object.__new__
"""Makes an object that has no field yet: what makes it sets them all."""


def _more(lane: Any, room: int, missing: int, size: int, most: int, path: str) -> tuple[bytearray, int]:
    """A lane with room for more rows of ``size`` bytes; a message that asks for more than ``most`` takes a length from what it says."""
    wanted = room + missing
    if wanted > most:
        raise _Failed(0, 0, (path,))
    if room or missing == 1:
        wanted = max(wanted, min(most, 2 * room), min(most, 16))
    grown = bytearray(wanted * size)
    grown[: len(lane)] = lane
    return grown, wanted
