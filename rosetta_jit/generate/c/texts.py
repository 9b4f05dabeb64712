"""Texts of schemas and mappings in C source: as literals and in comments, where none can end what it stands in."""

from __future__ import annotations

import re

MAX_LITERAL = 4000
"""C11, 5.2.4.1: compilers must take literals of 4095 bytes."""

MAX_COMMENT = 200


def literal(text: str) -> str:
    """A string literal: printable ASCII as it is, all else in octal, whose three digits end where they end."""
    data = text.encode("utf-8", "surrogateescape")
    if len(data) > MAX_LITERAL:
        data = data[:MAX_LITERAL] + b"..."
    return '"' + "".join(map(_escaped, data)) + '"'


def _escaped(byte: int) -> str:
    char = chr(byte)
    if char in '"\\':
        return f"\\{char}"
    return char if " " <= char <= "~" and char != "?" else f"\\{byte:03o}"  # two question marks begin a trigraph


def comment(text: str) -> str:
    """A comment of one line."""
    plain = ascii(" ".join(text.split()))[1:-1].replace("\\'", "'").replace("\\\\", "\\")
    if len(plain) > MAX_COMMENT:
        plain = f"{plain[:MAX_COMMENT]}..."
    return f"/* {re.sub('[*](?=/)|/(?=[*])', _apart, plain).replace('??', '? ?')} */"


def _apart(found: re.Match[str]) -> str:
    return f"{found.group()} "
