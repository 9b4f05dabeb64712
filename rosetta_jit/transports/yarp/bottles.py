"""Bottles as the carriers need them: how long one in bytes is, and text to bytes and back for the text carriers.

A bottle is `i32 code, i32 count` and its elements; the low byte of the code is the elements' tag where all have the same, else 0, and then
each has its own before it. What the values mean is the business of decoders.
"""

from __future__ import annotations

import struct
from typing import Any

from rosetta_jit.transports.feeding import ProtocolError
from rosetta_jit.transports.limits import MAX_BOTTLE_DEPTH

INT32, VOCAB, STRING, BLOB, INT64, LIST = 1, 9, 4, 12, 17, 256
GROUP = 768
FLOAT64 = {"yarp3": 10, "yarp4": 20}
WIDTHS: dict[str, dict[int, int]] = {
    "yarp3": {INT32: 4, INT64: 8, 32: 1, 64: 2, VOCAB: 4, 10: 8, 128: 4},
    "yarp4": {INT32: 4, INT64: 8, 32: 1, 64: 2, VOCAB: 4, 18: 8, 10: 4, 20: 8},
}
FORMATS = {INT32: "<i", INT64: "<q", 32: "<b", 64: "<h", 128: "<f", 20: "<d", 18: "<Q", VOCAB: "<I"}
"""But for tag 10, which is a float64 in YARP 3 and a float32 in YARP 4."""

UNIT = 255
_I32 = struct.Struct("<i")
_PAIR = struct.Struct("<ii")


def length_of(data: bytes | memoryview, dialect: str) -> int | None:
    """How many bytes a bottle takes that begins ``data``; None where it is none, or is not complete."""
    try:
        return _skip(data, 0, dialect, 0)
    except (struct.error, KeyError, ValueError):
        return None


def _skip(data: bytes | memoryview, at: int, dialect: str, depth: int) -> int:
    (code,) = _I32.unpack_from(data, at)
    return _skip_body(data, at + 4, code & UNIT, dialect, depth)


def _skip_body(data: bytes | memoryview, at: int, unit: int, dialect: str, depth: int) -> int:
    if depth > MAX_BOTTLE_DEPTH:
        raise ValueError(depth)
    (count,) = _I32.unpack_from(data, at)
    at, widths = at + 4, WIDTHS[dialect]
    if unit in widths:
        at += max(count, 0) * widths[unit]
    else:
        for _ in range(count):
            tag = unit
            if not unit:
                (tag,) = _I32.unpack_from(data, at)
                at += 4
            if tag in (STRING, BLOB):
                (size,) = _I32.unpack_from(data, at)
                if size < 0:
                    raise ValueError(size)
                at += 4 + size
            elif tag & GROUP == GROUP:
                at = _skip(data, at, dialect, depth + 1)
            elif tag & GROUP:
                at = _skip_body(data, at, tag & UNIT, dialect, depth + 1)
            else:
                at += widths[tag]
            if at > len(data):
                raise ValueError(at)
    if at > len(data):
        raise ValueError(at)
    return at


def is_open(text: str) -> bool:
    """Whether a text goes on in the next line: a bracket is open, or it ends with a backslash."""
    depth, quoted, escaped = 0, False, False
    for char in text:
        if escaped:
            escaped = False
        elif char == "\\":
            escaped = True
        elif char == '"':
            quoted = not quoted
        elif not quoted:
            depth += (char in "([{") - (char in ")]}")
    return depth > 0 or escaped


def from_text(text: str, dialect: str) -> bytes:
    """A bottle of its text, as YARP reads it.

    Raises
    ------
    ProtocolError
        Its lists are nested too deep.
    """
    tag, elements = _list(text, dialect, 0)
    return _PAIR.pack(LIST | tag & UNIT, len(elements)) + b"".join(elements)


def _list(text: str, dialect: str, depth: int) -> tuple[int, list[bytes]]:
    """The tag that all elements have, or 0; and their bytes, with their tags in this case."""
    if depth > MAX_BOTTLE_DEPTH:
        raise ProtocolError(f"lists nested deeper than {MAX_BOTTLE_DEPTH}")
    values = [_element(each, dialect, depth) for each in _tokens(text)]
    tags = {tag for tag, _ in values}
    if len(tags) == 1 and not min(tags) & GROUP:
        return min(tags), [data for _, data in values]
    return 0, [_I32.pack(tag) + data for tag, data in values]


def _element(word: str, dialect: str, depth: int) -> tuple[int, bytes]:
    match word[0]:
        case "(":
            tag, elements = _list(word[1:-1], dialect, depth + 1)
            return LIST | tag, _I32.pack(len(elements)) + b"".join(elements)
        case "[":
            return _vocab(word[1:-1].encode(), dialect)
        case "{":
            return BLOB, _sized(bytes(int(each) & 255 for each in word[1:-1].replace(",", " ").split() if each.lstrip("-").isdecimal()))
        case '"':
            return STRING, _sized(_unquoted(word).encode())
        case _:
            return _word(word, dialect)


def _word(word: str, dialect: str) -> tuple[int, bytes]:
    if word in ("true", "false"):
        return VOCAB, struct.pack("<I", ord("1") if word == "true" else 0)
    if word == "null":
        return _vocab(b"null", dialect)
    number = _number(word)
    if isinstance(number, float):
        return FLOAT64[dialect], struct.pack("<d", number)
    if number is not None:
        return (INT32, _I32.pack(number)) if -(2**31) <= number < 2**31 else (INT64, struct.pack("<q", number))
    return STRING, _sized(_unquoted(word).encode())


def _number(token: str) -> int | float | None:
    if token in ("inf", "-inf", "nan"):
        return float(token)
    digits = token.lstrip("+-")
    if not digits or not (digits[0].isdecimal() or digits[0] == ".") or not token.isascii() or "_" in token:
        return None
    try:
        if digits[:2].lower() == "0x":
            return int(token, 16) if len(digits) <= 10 else None
        if any(char in ".eE" for char in token):
            return float(token)
        found = int(token, 8) if digits[0] == "0" and len(digits) > 1 else int(token)
    except ValueError:
        return None
    return found if -(2**63) <= found < 2**63 else None


def _vocab(text: bytes, dialect: str) -> tuple[int, bytes]:
    if dialect == "yarp4" and len(text) > 4:
        return 18, text[:8].ljust(8, b"\0")
    return VOCAB, text[:4].ljust(4, b"\0")


def _sized(data: bytes) -> bytes:
    return _I32.pack(len(data)) + data


def _unquoted(token: str) -> str:
    out, escaped = list[str](), False
    for char in token:
        if escaped:
            out.append({"n": "\n", "r": "\r", "0": "\0"}.get(char, char))
            escaped = False
        elif char == "\\":
            escaped = True
        elif char != '"':
            out.append(char)
    return "".join(out)


def _tokens(text: str) -> list[str]:
    """The elements of a list's text. What an open bracket begins is dropped, as YARP does it."""
    found, depth, start = list[str](), 0, -1
    quoted = escaped = False
    for at, char in enumerate(text + " "):
        if escaped:
            escaped = False
        elif char == "\\":
            escaped = True
            start = at if start < 0 else start
        elif quoted or char == '"':
            quoted = quoted != (char == '"')
            start = at if start < 0 else start
        elif char in "([{":
            depth += 1
            start = at if start < 0 else start
        elif char in ")]}":
            depth -= 1
        elif char in " \t\r\n," and depth <= 0:
            if start >= 0:
                found.append(text[start:at])
            start, depth = -1, 0
        elif start < 0:
            start = at
    return found


def to_text(data: bytes | memoryview, dialect: str) -> str:
    """The text of a bottle, as YARP writes it but for floats, which have as few digits as say the same number.

    Raises
    ------
    ProtocolError
        It is no bottle of that dialect.
    """
    raw = bytes(data)
    if length_of(raw, dialect) != len(raw):
        raise ProtocolError("this is no bottle, and the text carriers carry nothing else")
    return _text(raw, 4, raw[0], dialect)[0]


def _text(data: bytes, at: int, unit: int, dialect: str) -> tuple[str, int]:
    (count,) = _I32.unpack_from(data, at)
    at, words = at + 4, list[str]()
    for _ in range(count):
        tag = unit
        if not unit:
            (tag,) = _I32.unpack_from(data, at)
            at += 4
        if tag & GROUP:
            start = at + 4 if tag & GROUP == GROUP else at
            inner, at = _text(data, start, data[at] if start != at else tag & UNIT, dialect)
            words.append(f"({inner})")
        elif tag in (STRING, BLOB):
            (size,) = _I32.unpack_from(data, at)
            words.append(_printed(tag, data[at + 4 : at + 4 + size]))
            at += 4 + size
        else:
            width = WIDTHS[dialect][tag]
            form = FORMATS.get(tag) or ("<d" if dialect == "yarp3" else "<f")
            words.append(_printed(tag, struct.unpack_from(form, data, at)[0], data[at : at + width]))
            at += width
    return " ".join(words), at


def _printed(tag: int, value: Any, raw: bytes = b"") -> str:
    match tag:
        case 4:
            return _quoted(value.decode("utf-8", "replace"))
        case 12:
            return "{" + " ".join(map(str, value)) + "}"
        case 9 | 18:
            return "true" if value == ord("1") else "false" if not value else f"[{raw.rstrip(bytes(1)).decode('ascii', 'replace')}]"
        case _ if isinstance(value, float):
            text = repr(value)
            return text if any(char in text for char in ".en") else f"{text}.0"
        case _:
            return str(value)


def _quoted(text: str) -> str:
    plain = text.isascii() and text[:1].isalpha() and all(char.isalnum() or char in "_.-" for char in text)
    if plain and text not in ("true", "false", "null", "inf", "nan"):
        return text
    for char, escape in (("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("\r", "\\r"), ("\0", "\\0")):
        text = text.replace(char, escape)
    return f'"{text}"'
