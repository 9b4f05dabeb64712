"""Floats in decimal: what `Nearest`, `Digits` and `Scale` of the kernel mean, exact to the last bit."""

from __future__ import annotations

import math

import numpy as np

from rosetta_jit.kernel.limits import MAX_DIGITS

FIRST = {"f32": 6, "f64": 15}
"""As many digits any number in decimal keeps on its way through a normal float, so that fewer never read back where these do not."""

LEAST_NORMAL = {"f32": 2.0**-126, "f64": 2.0**-1022}
LAST = {"f32": 9, "f64": 17}
"""As many digits tell any two floats apart."""


def nearest(text: bytes, exponent: int) -> np.float64:
    """The float64 nearest to the integer that the digits of a text spell, times a power of ten; other bytes are passed over."""
    digits = bytes(byte for byte in text if 48 <= byte < 58).lstrip(b"0")
    kept, dropped = digits[:MAX_DIGITS], digits[MAX_DIGITS:]
    if dropped.strip(b"0"):
        kept, dropped = kept + b"1", dropped[1:]
    return np.float64(f"{kept.decode() or '0'}e{exponent + len(dropped)}")


def shortest(type_: str, value: float) -> tuple[int, int]:
    """Digits and scale: the fewest digits that read back as the value, of such the nearest ones; 0 for what is not finite.

    Above a power of two, numbers that read back as it reach twice as far as below, so that the nearest ones may not be among them.
    """
    size = abs(float(value))
    if not math.isfinite(size) or size == 0:
        return 0, 0
    for count in range(FIRST[type_] if size >= LEAST_NORMAL[type_] else 1, LAST[type_] + 1):
        mantissa, _, exponent = f"{size:.{count - 1}e}".partition("e")
        rounded, power = int(mantissa.replace(".", "")), int(exponent) - (count - 1)
        for found in (rounded, rounded + 1) if math.frexp(size)[0] == 0.5 else (rounded,):
            if _as(type_, float(f"{found}e{power}")) == size or count == LAST[type_]:
                return found, power
    raise AssertionError(value)


def digits(type_: str, value: float, places: int | None) -> int:
    """The digits of the absolute value as an integer: the `shortest`, or those to a number of decimals, of which the low 64 bits count."""
    size = abs(float(value))
    if places is None:
        return shortest(type_, value)[0]
    return int(f"{size:.{places}f}".replace(".", "")) & (1 << 64) - 1 if math.isfinite(size) else 0


def scale(type_: str, value: float) -> int:
    """The power of ten by which the `shortest` digits are the value."""
    return shortest(type_, value)[1]


def _as(type_: str, number: float) -> float:
    with np.errstate(over="ignore"):
        return float(np.float32(number)) if type_ == "f32" else number
