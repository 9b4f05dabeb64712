"""Numbers and strings as the language writes them.

https://protobuf.dev/reference/protobuf/proto3-spec, "Lexical elements".
"""

from __future__ import annotations

import re

from rosetta_jit.frameworks.protobuf.limits import MAX_DIGITS

INTEGER = r"0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*"
FLOAT = r"(?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))(?:[eE][+-]?[0-9]+)?"
ESCAPE = (
    r"\\(?:(?P<octal>[0-7]{1,3})|[xX](?P<hex>[0-9a-fA-F]{1,2})|u(?P<u4>[0-9a-fA-F]{4})|U(?P<u8>[0-9a-fA-F]{8})"
    r"|(?P<letter>[abfnrtv\\'\"?])|(?P<wrong>(?s:.)?))"
)
LETTERS = {"a": 7, "b": 8, "f": 12, "n": 10, "r": 13, "t": 9, "v": 11}


class EscapeError(ValueError):
    """A backslash with something behind it that means nothing; ``args[0]`` is the offset."""


def number(text: str) -> int | float | None:
    """The number that a token spells; None where it spells none."""
    if re.fullmatch(INTEGER, text):
        return _integer(text) if len(text) <= MAX_DIGITS else _too_long(text)
    return float(text) if re.fullmatch(FLOAT, text) else None


def string(text: str) -> bytes:
    """The bytes between the quotes of a string token, escapes replaced; raises EscapeError."""
    return unescape(text[1:-1])


def unescape(text: str) -> bytes:
    """Replace C escapes; everything else is UTF-8; raises EscapeError."""
    if "\\" not in text:
        return text.encode("utf-8", "surrogatepass")
    out = bytearray()
    end = 0
    for match in re.finditer(ESCAPE, text):
        out += text[end : match.start()].encode("utf-8", "surrogatepass")
        out += _escape(match)
        end = match.end()
    out += text[end:].encode("utf-8", "surrogatepass")
    return bytes(out)


def _integer(text: str) -> int:
    if text[:2] in ("0x", "0X"):
        return int(text, 16)
    return int(text, 8) if text[0] == "0" else int(text)


def _too_long(text: str) -> float | None:
    """A decimal integer is a number where a float is wanted, however long it is."""
    return None if text[0] == "0" else float(text)


def _escape(match: re.Match[str]) -> bytes:
    kind = match.lastgroup
    value = match[kind] if kind else ""
    match kind:
        case "octal":
            return bytes([int(value, 8) & 0xFF])
        case "hex":
            return bytes([int(value, 16)])
        case "u4" | "u8" if int(value, 16) <= 0x10FFFF:
            return chr(int(value, 16)).encode("utf-8", "surrogatepass")
        case "letter":
            return bytes([LETTERS.get(value, ord(value))])
        case _:
            raise EscapeError(match.start())
