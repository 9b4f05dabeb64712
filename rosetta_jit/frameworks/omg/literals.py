"""What the literals of IDL mean (OMG IDL 4.2, 7.2.6)."""

from __future__ import annotations

import re
from math import isfinite

from rosetta_jit.frameworks.omg.limits import MAX_DIGITS

FLOATING = re.compile(r"(?:[0-9]+\.[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[0-9]+[eE][+-]?[0-9]+")
FIXED = re.compile(r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)[dD]")
INTEGER = re.compile(r"0[xX][0-9A-Fa-f]+|0[0-7]*|[1-9][0-9]*")
ESCAPE = re.compile(
    r"\\(?:(?P<octal>[0-7]{1,3})|x(?P<hex>[0-9A-Fa-f]{1,2})|u(?P<unicode>[0-9A-Fa-f]{1,4})|(?P<letter>[ntvbrfa\\?'\"]))|\\(?P<wrong>.)"
)
LETTERS = {"n": "\n", "t": "\t", "v": "\v", "b": "\b", "r": "\r", "f": "\f", "a": "\a"}


class LiteralError(Exception):
    """Nothing is written like this; the first argument says what is wrong."""


def number(text: str) -> int | float | None:
    """The value of a number; None for one in fixed point.

    Raises
    ------
    LiteralError
        It is misspelt, or too large.
    """
    if len(text) > MAX_DIGITS:
        raise LiteralError("too long")
    if INTEGER.fullmatch(text):
        digits = text.lower()
        return int(digits, 16) if digits.startswith("0x") else int(digits, 8) if digits.startswith("0") else int(digits)
    if FLOATING.fullmatch(text):
        value = float(text)
        if not isfinite(value):
            raise LiteralError("too large for a `double`")
        return value
    if FIXED.fullmatch(text):
        return None
    raise LiteralError("not a number")


def unescape(text: str, *, wide: bool) -> str:
    r"""The characters of a string or character literal without its quotes.

    Raises
    ------
    LiteralError
        An escape means nothing, or is `\u` in a narrow literal, or stands for NUL.
    """

    def replaced(match: re.Match[str]) -> str:
        kind = match.lastgroup
        value = match[kind] if kind else ""
        match kind:
            case "octal" if int(value, 8) < 256:
                return chr(int(value, 8))
            case "hex":
                return chr(int(value, 16))
            case "unicode" if wide:
                return chr(int(value, 16))
            case "letter":
                return LETTERS.get(value, value)
            case _:
                raise LiteralError(f"`{match[0]}` means nothing here")

    return ESCAPE.sub(replaced, text)
