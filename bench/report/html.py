"""A run as one page of HTML: its style and its plots are in it, and nothing is loaded."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from bench.figures import chapters
from bench.report import plot, tables

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from bench.figures import Comparison, Curve, Report

HOW = (
    "All contenders of a job were measured in turns. Figures are medians over the rounds with their quartiles; ratios are those of single "
    "rounds, so that a busy moment of the machine hits both alike. Time is that of the thread, or of the process, on a processor; where "
    "several threads work it is the clock's. Contenders and curves have logarithmic axes."
)
STYLE = Path(__file__).with_name("style.css")


def page(report: Report, about: Mapping[str, str]) -> str:
    """The whole page."""
    body = "".join(_body(report, about))
    style = STYLE.read_text("utf-8")
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>Benchmarks</title><style>{style}</style>'
    return f'<!DOCTYPE html><html lang="en"><head>{head}</head><body>{body}</body></html>\n'


def _body(report: Report, about: Mapping[str, str]) -> Iterator[str]:
    yield "<h1>Benchmarks of rosetta_jit</h1>"
    yield f"<p>{escape(HOW)}</p>"
    yield _table((), about.items())
    yield "<h2>Targets</h2>"
    yield _table(tables.TARGETS, map(tables.target, report.rows))
    for chapter, comparisons in chapters(report.comparisons).items():
        yield f"<h2>{escape(chapter)}</h2>"
        yield from map(_comparison, comparisons)
    yield "<h2>How costs grow</h2><p>The exponent k of x<sup>k</sup> is fitted over the upper half of each curve.</p>"
    yield from map(_curve, report.curves)


def _comparison(comparison: Comparison) -> str:
    table = _table(*tables.contenders(comparison))
    return f"<section><h3>{escape(comparison.title)}</h3>{plot.bars(comparison)}{table}</section>"


def _curve(curve: Curve) -> str:
    drawn = plot.stacked(curve) + _table(*tables.shares(curve)) if curve.parts else plot.lines(curve)
    note = f"<p>{escape(curve.note)}</p>" if curve.note else ""
    return f"<section><h3>{escape(curve.title)}</h3>{drawn}{note}{_table(tables.GROWTH, tables.growth(curve))}</section>"


def _table(head: Iterable[str], lines: Iterable[Iterable[str]]) -> str:
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    rows = "".join(f"<tr>{''.join(_cell(cell) for cell in line)}</tr>" for line in lines)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{rows}</tbody></table>"


def _cell(text: str) -> str:
    mark = f' class="{text}"' if text in {"met", "missed"} else ' class="missed"' if text.startswith("steeper") else ""
    return f"<td{mark}>{escape(text)}</td>"
