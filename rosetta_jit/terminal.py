"""Text as it stands in a terminal: which characters may get there, and how many cells each fills."""

from __future__ import annotations

TAB_CELLS = 4
WIDE = frozenset(("W", "F"))
"""East Asian widths of characters that fill two cells: Unicode Standard Annex 11."""


def printable(text: str) -> str:
    """A text without what could command a terminal or turn its direction: such characters stand as their codes."""
    return "".join(char if char.isprintable() else _code(char) for char in text)


def _code(char: str) -> str:
    number = ord(char)
    return f"\\x{number:02x}" if number < 256 else f"\\u{number:04x}" if number < 65536 else f"\\U{number:08x}"


def cells(text: str) -> int:
    """How many cells a printable text fills."""
    return len(text) if text.isascii() else sum(map(_cells, text))


def _cells(char: str) -> int:
    import unicodedata  # a library of its own to load, and most texts are ASCII

    if unicodedata.combining(char):
        return 0
    return 2 if unicodedata.east_asian_width(char) in WIDE else 1


def padded(text: str, width: int) -> str:
    """A text, filled up with blanks to so many cells."""
    return text + " " * (width - cells(text))


def cut(text: str, width: int) -> str:
    """A text of at most so many cells, with an ellipsis where it was longer."""
    if cells(text) <= width:
        return text
    kept, filled = "", 1
    for char in text:
        filled += _cells(char)
        if filled > width:
            break
        kept += char
    return kept + "…"


def columns(rows: list[tuple[str, ...]]) -> list[str]:
    """Rows with their cells below each other."""
    count = max(map(len, rows), default=0)
    widths = [max((cells(row[number]) for row in rows if number < len(row)), default=0) for number in range(count)]
    return ["  ".join(padded(cell, width) for cell, width in zip(row, widths, strict=False)).rstrip() for row in rows]


def wrapped(text: str, width: int, *, first: str = "", then: str = "") -> list[str]:
    """A text in lines of so many cells, broken at blanks; ``first`` and ``then`` stand before the first line and before the others."""
    lines, line = list[str](), first
    for number, word in enumerate(text.split(" ")):
        glue = " " if number and line != then else ""
        if glue and cells(line) + 1 + cells(word) > width:
            lines.append(line)
            line, glue = then, ""
        line += glue + word
    return [cut(each, width) for each in [*lines, line]]
