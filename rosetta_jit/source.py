"""Text and places in it: what every diagnostic points at."""

from __future__ import annotations

from bisect import bisect_right
from functools import lru_cache
from itertools import accumulate
from pathlib import Path

from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Source:
    """One text that was read: an IDL file, a wire schema, a mapping.

    ``name`` is what a person knows it by, usually the path it was found at.
    """

    name: str
    text: str

    def line_column(self, offset: int) -> tuple[int, int]:
        """Line and column of a character offset, both counted from 1."""
        starts = _line_starts(self.text)
        line = bisect_right(starts, offset)
        return line, offset - starts[line - 1] + 1


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


def shipped_folders() -> tuple[Path, ...]:
    """The IDL files and mappings of the package: in its data folder when installed, else those of the checkout."""
    package = Path(__file__).parent
    root = package / "share" if (package / "share").is_dir() else package.parent
    return (root / "idl", root / "mappings")


@lru_cache(maxsize=8)
def _line_starts(text: str) -> tuple[int, ...]:
    """Where each line begins: looked up for every report of a text, found once."""
    return 0, *accumulate(len(line) + 1 for line in text.split("\n")[:-1])
