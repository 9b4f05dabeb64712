"""A diagnostic is data; rendering it with its line and a caret is a function.

The words of each diagnostic stand in `rosetta_jit.catalogue`, one function a mistake, never where it is noticed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from rosetta_jit.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.source import Span

MAX_LINE = 160
"""Longer source lines are cut around the caret, so that a hostile line cannot flood a terminal."""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One mistake in a text.

    ``code`` is the stable name of the mistake (``unknown-field``), ``label`` the words at the caret, ``help`` what to do.
    """

    severity: Literal["error", "warning"]
    code: str
    message: str
    span: Span | None = None
    label: str = ""
    notes: tuple[str, ...] = ()
    help: str = ""


def render(diagnostic: Diagnostic) -> str:
    """The report that a person reads: message, place, the line with a caret below, notes, help."""
    lines = [f"{diagnostic.severity}[{diagnostic.code}]: {diagnostic.message}"]
    if diagnostic.span is not None:
        lines += _excerpt(diagnostic.span, diagnostic.label)
    lines += [f"  = note: {note}" for note in diagnostic.notes]
    if diagnostic.help:
        lines.append(f"  = help: {diagnostic.help}")
    return "\n".join(_printable(line) for line in lines)


def to_json(diagnostic: Diagnostic) -> dict[str, object]:
    """The same for a program: plain values, lines and columns counted from 1."""
    place: dict[str, object] = {}
    if diagnostic.span is not None:
        line, column = diagnostic.span.source.line_column(diagnostic.span.start)
        place = {"file": diagnostic.span.source.name, "line": line, "column": column}
    return {
        "severity": diagnostic.severity,
        "code": diagnostic.code,
        "message": diagnostic.message,
        **place,
        "label": diagnostic.label,
        "notes": list(diagnostic.notes),
        "help": diagnostic.help,
    }


def _excerpt(span: Span, label: str) -> list[str]:
    line_number, column = span.source.line_column(span.start)
    start = span.start - column + 1
    end = span.source.text.find("\n", start)
    line = span.source.text[start : end if end >= 0 else len(span.source.text)].replace("\t", " ")
    cut = max(0, column - 1 - MAX_LINE // 2)
    width = max(1, min(span.end, start + len(line)) - span.start)
    shown = line[cut : cut + MAX_LINE]
    caret = " " * (column - 1 - cut) + "^" * min(width, MAX_LINE - (column - 1 - cut))
    margin = " " * len(str(line_number))
    return [
        f"{margin}--> {span.source.name}:{line_number}:{column}",
        f"{margin} |",
        f"{line_number} | {shown}",
        f"{margin} | {caret} {label}".rstrip(),
    ]


def _printable(line: str) -> str:
    """Control characters of a hostile text must not reach a terminal."""
    return "".join(char if char.isprintable() else f"\\x{ord(char):02x}" for char in line)
