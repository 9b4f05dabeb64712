"""The table of targets between two marks of the README."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.report.markdown import targets

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from bench.figures import Row

BEGIN, END = "<!-- speed: written by `make bench` -->\n", "<!-- speed: end -->"


def insert_in_readme(rows: Sequence[Row], readme: Path) -> None:
    """Replace what stands between the two marks."""
    text = readme.read_text("utf-8")
    head, begin, rest = text.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if begin and end:
        readme.write_text(f"{head}{begin}{targets(rows)}{end}{tail}", "utf-8")
