"""A run as Markdown: targets, comparisons, slopes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.figures import chapters
from bench.report import tables

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from bench.figures import Curve, Report, Row


def page(report: Report, about: Mapping[str, str]) -> str:
    """The whole report."""
    parts = ["# Benchmarks\n", table(("", ""), about.items()), "\n## Targets\n", targets(report.rows)]
    for chapter, comparisons in chapters(report.comparisons).items():
        parts += [f"\n## {chapter}\n", *(f"\n### {each.title}\n\n{table(*tables.contenders(each))}" for each in comparisons)]
    parts += ["\n## How costs grow\n", slopes(report.curves)]
    parts += [f"\n### {each.title}\n\n{table(*tables.shares(each))}" for each in report.curves if each.parts]
    return "\n".join(parts)


def targets(rows: Sequence[Row]) -> str:
    """The table of the README: ratios against their limits."""
    lines = (
        (what, measured, at_most, " - ".join(each for each in ("**missed**" if mark == "missed" else mark, detail) if each))
        for what, measured, at_most, mark, detail in map(tables.target, rows)
    )
    return table(tables.TARGETS[:-1], lines)


def slopes(curves: Sequence[Curve]) -> str:
    """The exponent of each series, and what is superlinear."""
    lines = (
        (curve.title, who, reach, grows, " - ".join(each for each in (f"**{mark}**" if mark else "", curve.note) if each))
        for curve in curves
        for who, reach, grows, mark in tables.growth(curve)
    )
    return table(("curve", *tables.GROWTH), lines)


def table(head: Iterable[str], lines: Iterable[Iterable[str]]) -> str:
    """A table whose cells may hold anything but line ends."""
    head = tuple(head)
    rows = [head, ("---",) * len(head), *lines]
    return "".join(_line(row) for row in rows)


def _line(cells: Iterable[str]) -> str:
    return "|" + "|".join(cell if cell == "---" else f" {cell} ".replace("|", "\\|") for cell in cells) + "|\n"
