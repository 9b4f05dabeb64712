"""Numbers as lcm-gen reads them: C's `strtoll` with base 0, and `strtod`, which must take the whole word."""

from __future__ import annotations

import re
from math import isfinite

from rosetta_jit.frameworks.lcm.limits import MAX_DIGITS

_INTEGER = re.compile(r"-?(0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)")
_DECIMAL = re.compile(r"-?([0-9]+(?:\.[0-9]*)?|\.[0-9]+)([eE]-?[0-9]+)?")
_HEXADECIMAL = re.compile(r"-?0[xX]([0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]+)([pP]-?[0-9]+)?")


def integer(text: str) -> int | None:
    """A decimal, hexadecimal or octal number (``010`` is 8); None if it is none."""
    if len(text) > MAX_DIGITS or not _INTEGER.fullmatch(text):
        return None
    digits = text.removeprefix("-")
    base = 16 if digits[1:2] in {"x", "X"} else 8 if digits.startswith("0") else 10
    return -int(digits, base) if text.startswith("-") else int(digits, base)


def floating(text: str) -> float | None:
    """A finite number; None if it is none."""
    if len(text) > MAX_DIGITS:
        return None
    try:
        value = float.fromhex(text) if _HEXADECIMAL.fullmatch(text) else float(text) if _DECIMAL.fullmatch(text) else None
    except OverflowError:
        return None
    return value if value is not None and isfinite(value) else None
