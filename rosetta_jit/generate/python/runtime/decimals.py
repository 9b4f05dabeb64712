"""Decimal numbers in texts."""

# pyright: reportUnusedFunction=false, reportPrivateUsage=false

from __future__ import annotations

import math
from typing import Any

from rosetta_jit.generate.python.runtime.numbers import _single


def _nearest(text: Any, exponent: int) -> float:
    """The float nearest to the integer that the digits of a text spell, times a power of ten; other bytes are passed over."""
    digits = "".join(chr(each) for each in text if 48 <= each < 58).lstrip("0")
    kept, dropped = digits[:800], digits[800:]
    if dropped.strip("0"):
        kept, dropped = kept + "1", dropped[1:]
    return float(f"{kept or '0'}e{exponent + len(dropped)}")


def _shortest(number: float, bits: int) -> tuple[int, int]:
    """The fewest digits that read back as a float of 32 or 64 bits, and their power of ten; 0 for what is not finite.

    Of normal numbers they are not fewer than any float keeps. Above a power of two the nearest digits may not be among them.
    """
    size = abs(number)
    if not math.isfinite(size) or size == 0:
        return 0, 0
    first, last, least = (15, 17, 2.0**-1022) if bits == 64 else (6, 9, 2.0**-126)
    for count in range(first if size >= least else 1, last + 1):
        mantissa, _, exponent = f"{size:.{count - 1}e}".partition("e")
        rounded, power = int(mantissa.replace(".", "")), int(exponent) - (count - 1)
        for found in (rounded, rounded + 1) if math.frexp(size)[0] == 0.5 else (rounded,):
            read = float(f"{found}e{power}")
            if count == last or (read if bits == 64 else _single(read)) == size:
                return found, power
    raise AssertionError(number)


def _fixed_digits(number: float, places: int) -> int:
    """The digits of a number rounded to so many decimals, of which the low 64 bits count; 0 for what is not finite."""
    size = abs(number)
    return int(f"{size:.{places}f}".replace(".", "")) & 0xFFFFFFFFFFFFFFFF if math.isfinite(size) else 0
