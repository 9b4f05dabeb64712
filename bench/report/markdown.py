"""A run as Markdown: targets, comparisons, slopes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.figures import chapters, ratio
from bench.report import words
from bench.slopes import exponent, too_steep

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from bench.figures import Comparison, Curve, Report, Row


def page(report: Report, about: Mapping[str, str]) -> str:
    """The whole report."""
    parts = ["# Benchmarks\n", table(("", ""), about.items()), "\n## Targets\n", targets(report.rows)]
    for chapter, comparisons in chapters(report.comparisons).items():
        parts += [f"\n## {chapter}\n", *(f"\n### {each.title}\n\n{contenders(each)}" for each in comparisons)]
    parts += ["\n## How costs grow\n", slopes(report.curves)]
    return "\n".join(parts)


def targets(rows: Sequence[Row]) -> str:
    """The table of the README: ratios against their limits."""
    lines: list[tuple[str, ...]] = []
    for row in rows:
        target = "" if row.at_most is None else f"{row.at_most:.3g} {row.unit}"
        mark = "" if row.at_most is None else "met" if row.met else "**missed**"
        lines.append((row.what, f"{row.measured.median:.3g} {row.unit}", target, " - ".join(each for each in (mark, row.detail) if each)))
    return table(("what", "measured", "at most", ""), lines)


def contenders(comparison: Comparison) -> str:
    """One job: who took how long, what that is of ours, and what it made."""
    ours = comparison.figures[0]
    lines = [
        (
            each.who,
            each.makes,
            words.spread_of_time(each.took),
            "" if each is ours or ours.role != "ours" else words.ratio(ratio(ours.rounds_ns, each.rounds_ns)),
        )
        for each in comparison.figures
    ]
    return table(("who", "makes", "median (quartiles)", f"{ours.who}, as a multiple" if ours.role == "ours" else ""), lines)


def slopes(curves: Sequence[Curve]) -> str:
    """The exponent of each series, and what is superlinear."""
    lines: list[tuple[str, ...]] = []
    for curve in curves:
        steep = too_steep(curve)
        for each in curve.series:
            (first, lowest), (last, highest) = each.points[0], each.points[-1]
            reach = f"{words.count(first)} to {words.count(last)}: {lowest.median:.3g} to {highest.median:.3g} {curve.y}"
            mark = f"**steeper than the job** (x^{curve.may_grow:g})" if each.who in steep else ""
            lines.append((curve.title, each.who, reach, f"x^{exponent(each):.2f}", " - ".join(part for part in (mark, curve.note) if part)))
    return table(("curve", "of", "reach", "grows as", ""), lines)


def table(head: Iterable[str], lines: Iterable[Iterable[str]]) -> str:
    """A table whose cells may hold anything but line ends."""
    head = tuple(head)
    rows = [head, ("---",) * len(head), *lines]
    return "".join(_line(row) for row in rows)


def _line(cells: Iterable[str]) -> str:
    return "|" + "|".join(cell if cell == "---" else f" {cell} ".replace("|", "\\|") for cell in cells) + "|\n"
