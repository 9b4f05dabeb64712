"""A diagnostic is data; rendering it with its line and a caret is a function.

The words of each diagnostic stand in `rosetta_jit.catalogue` or with their framework, never where a mistake is noticed: each is a
function, or a `Mistake` where the place is all that differs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit import terminal
    from rosetta_jit.source import Span
else:
    terminal = Late("rosetta_jit.terminal")

MAX_LINE = 160
"""Longer source lines are cut around the caret, so that a hostile line cannot flood a terminal."""

MAX_WORDS = 2_000
"""Characters of a message, note or help that are shown."""

MAX_REPORTED = 50
"""Diagnostics of one report that are shown; more are counted."""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One mistake in a text; as a note, something that the text leaves to the compiler, and what that did.

    ``code`` is the stable name of the mistake (``unknown-field``), ``label`` the words at the caret, ``help`` what to do.
    """

    severity: Literal["error", "warning", "note"]
    code: str
    message: str
    span: Span | None = None
    label: str = ""
    notes: tuple[str, ...] = ()
    help: str = ""


def error(code: str, message: str, span: Span | None = None, label: str = "", help_: str = "", notes: tuple[str, ...] = ()) -> Diagnostic:
    """Something that is wrong, with the parts that most reports have."""
    return Diagnostic("error", code, message, span, label, notes, help_)


def warning(code: str, message: str, span: Span | None = None, label: str = "", help_: str = "") -> Diagnostic:
    """Something that is suspect and not wrong."""
    return Diagnostic("warning", code, message, span, label, (), help_)


def note(code: str, message: str, span: Span | None = None, label: str = "", help_: str = "", notes: tuple[str, ...] = ()) -> Diagnostic:
    """Something that the text leaves open, and what is made of it."""
    return Diagnostic("note", code, message, span, label, notes, help_)


@dataclass(frozen=True, slots=True)
class Mistake:
    """An error whose words are always the same: called with the place, it is the diagnostic. Others are functions of what they tell."""

    code: str
    message: str
    label: str = ""
    help: str = ""
    notes: tuple[str, ...] = ()

    def __call__(self, span: Span | None) -> Diagnostic:
        return Diagnostic("error", self.code, self.message, span, self.label, self.notes, self.help)


def render(diagnostic: Diagnostic) -> str:
    """The report that a person reads: message, place, the line with a caret below, notes, help."""
    lines = [f"{diagnostic.severity}[{diagnostic.code}]: {diagnostic.message}"]
    if diagnostic.span is not None:
        lines += _excerpt(diagnostic.span, diagnostic.label)
    lines += [f"  = note: {note}" for note in diagnostic.notes]
    if diagnostic.help:
        lines.append(f"  = help: {diagnostic.help}")
    return "\n".join(terminal.printable(line[:MAX_WORDS]) for line in lines)


def render_all(diagnostics: Sequence[Diagnostic]) -> str:
    """One report of several: errors first where not all are shown."""
    if len(diagnostics) <= MAX_REPORTED:
        return "\n\n".join(map(render, diagnostics))
    shown = sorted(diagnostics, key=lambda each: each.severity)[:MAX_REPORTED]
    return "\n\n".join([*map(render, shown), f"and {len(diagnostics) - MAX_REPORTED} more"])


def to_json(diagnostic: Diagnostic) -> dict[str, object]:
    """The same for a program: plain values, always the same fields; lines and columns are counted from 1, and `end` is exclusive."""
    line = column = end_line = end_column = None
    if diagnostic.span is not None:
        source = diagnostic.span.source
        line, column = source.line_column(diagnostic.span.start)
        end_line, end_column = source.line_column(diagnostic.span.end)
    return {
        "file": None if diagnostic.span is None else diagnostic.span.source.name,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
        "severity": diagnostic.severity,
        "code": diagnostic.code,
        "message": diagnostic.message,
        "label": diagnostic.label,
        "help": diagnostic.help,
        "notes": list(diagnostic.notes),
    }


def _excerpt(span: Span, label: str) -> list[str]:
    """The line of a place, cut around it, with carets below as many cells as the place fills."""
    text = span.source.text
    line_number, column = span.source.line_column(span.start)
    start = span.start - column + 1
    first = start if _end(text, start) < start + MAX_LINE else max(start, span.start - MAX_LINE // 2)
    last = _end(text, first)
    before, marked = _shown(text[first : span.start]), _shown(text[span.start : min(span.end, last)])
    before = before if first == start else f"…{before[1:]}"
    caret = " " * terminal.cells(before) + "^" * max(1, terminal.cells(marked))
    margin = " " * len(str(line_number))
    return [
        f"{margin}--> {span.source.name}:{line_number}:{column}",
        f"{margin} |",
        f"{line_number} | {before}{marked}{_shown(text[max(span.start, min(span.end, last)) : last])}".rstrip(),
        f"{margin} | {caret} {label}".rstrip(),
    ]


def _end(text: str, start: int) -> int:
    """Where a line ends, or where the part of it that is shown does."""
    last = min(len(text), start + MAX_LINE)
    end = text.find("\n", start, last)
    return last if end < 0 else end


def _shown(text: str) -> str:
    """A part of a line with blanks for tabs, and codes for what does not print, so that carets can be counted."""
    return terminal.printable(text.replace("\t", " " * terminal.TAB_CELLS).rstrip("\r"))
