"""Text and places in it: what every diagnostic points at."""

from __future__ import annotations

from rosetta_jit.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Source:
    """One text that was read: an IDL file, a wire schema, a mapping.

    ``name`` is what a person knows it by, usually the path it was found at.
    """

    name: str
    text: str

    def line_column(self, offset: int) -> tuple[int, int]:
        """Line and column of a character offset, both counted from 1."""
        line_start = self.text.rfind("\n", 0, offset) + 1
        return self.text.count("\n", 0, offset) + 1, offset - line_start + 1


@dataclass(frozen=True, slots=True)
class Span:
    """Characters ``start`` to ``end`` (exclusive) of a source."""

    source: Source
    start: int
    end: int

    def to(self, last: Span) -> Span:
        """The span from the start of this one to the end of ``last``, in the same source."""
        return Span(self.source, self.start, last.end)

    def __str__(self) -> str:
        line, column = self.source.line_column(self.start)
        return f"{self.source.name}:{line}:{column}"
