"""Plots as inline SVG: lines over logarithmic axes, bars with quartiles, stacked shares. Colours come from the page's style."""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

from bench.report import words

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from bench.figures import Comparison, Curve, Row

WIDTH, HEIGHT = 560, 320
LEFT, RIGHT, TOP, BOTTOM = 64, 12, 12, 44
ROW = 22
LABEL = 250
WIDE, WIDE_LABEL, WIDE_NOTE = 1080, 390, 290
"""The width of a picture that stands alone, and what of it is for names and for figures."""

ALONE = (
    "svg{font:13px system-ui,sans-serif;background:#fff}text{fill:#1c2733}.name{text-anchor:end}.tick{text-anchor:middle;fill:#6d7b8a}"
    ".grid{stroke:#d8dee6}.one{stroke:#6d7b8a}.bar{stroke-width:4}.ours{fill:#0b6bcb;stroke:#0b6bcb}.target{stroke:#2b8a3e;stroke-width:3}"
)
"""The style of such a picture: no page gives it one."""

HUES = 8
"""Lines have this many colours, `.c0` and on, in the page's style."""


@dataclass(frozen=True, slots=True)
class Scale:
    """A logarithmic axis: from a value to a place in the picture."""

    low: float
    high: float
    begin: float
    end: float

    @classmethod
    def over(cls, values: Sequence[float], begin: float, end: float) -> Scale:
        low, high = min(values), max(values)
        return cls(low / 1.15, max(high, low * 10) * 1.15, begin, end)

    def at(self, value: float) -> float:
        share = math.log(max(value, self.low) / self.low) / math.log(self.high / self.low)
        return self.begin + share * (self.end - self.begin)

    def ticks(self) -> list[float]:
        """Powers of ten within, no more of them than can be read; where they are few, what lies between."""
        first, last = math.floor(math.log10(self.low)), math.floor(math.log10(self.high))
        step = max(1, (last - first - 1) // 8 + 1)
        between = (1.0, 2.0, 5.0) if last - first < 3 else (1.0,)
        found = [part * 10.0**power for power in range(first, last + 1, step) for part in between]
        return [value for value in found if self.low <= value <= self.high]


def lines(curve: Curve) -> str:
    """A curve: a line a series, quartiles as strokes."""
    shown = [[(x, cost) for x, cost in each.points if cost.median > 0] for each in curve.series]
    xs, costs = [x for points in shown for x, _ in points], [cost for points in shown for _, cost in points]
    across = Scale.over(xs, LEFT, WIDTH - RIGHT)
    up = Scale.over([max(each.low, each.median / 10) for each in costs] + [each.high for each in costs], HEIGHT - BOTTOM, TOP)
    parts = [*_grid(across, up, curve.x, curve.y)]
    for number, (series, points) in enumerate(zip(curve.series, shown, strict=True)):
        style = f"c{number % HUES}" + (" limit" if series.role == "limit" else "")
        path = " ".join(f"{across.at(x):.1f},{up.at(cost.median):.1f}" for x, cost in points)
        parts.append(f'<polyline class="{style}" points="{path}"/>')
        for x, cost in points:
            place = across.at(x)
            parts.append(
                f'<line class="{style}" x1="{place:.1f}" x2="{place:.1f}" y1="{up.at(cost.low):.1f}" y2="{up.at(cost.high):.1f}"/>'
            )
            told = f"{series.who}: {cost.median:.4g} {curve.y} at {words.count(x)}"
            parts.append(
                f'<circle class="{style}" cx="{place:.1f}" cy="{up.at(cost.median):.1f}" r="3"><title>{escape(told)}</title></circle>'
            )
    return _picture(HEIGHT, parts) + _legend([each.who for each in curve.series])


def stacked(curve: Curve) -> str:
    """A curve whose series add up: a bar for each x, its shares in their colours."""
    xs = [x for x, _ in curve.series[0].points]
    totals = [sum(each.points[number][1].median for each in curve.series) for number in range(len(xs))]
    parts: list[str] = []
    for number, x in enumerate(xs):
        top, left = TOP + number * ROW * 1.3, float(LEFT)
        parts.append(f'<text class="name" x="{LEFT - 6}" y="{top + 14:.1f}">{words.count(x)} {escape(curve.x)}</text>')
        for hue, series in enumerate(curve.series):
            cost = series.points[number][1].median
            width = cost / max(totals) * (WIDTH - LEFT - 90)
            told = f"{series.who}: {cost:.3g} {curve.y}, {100 * cost / totals[number]:.0f} %"
            parts.append(f'<rect class="c{hue % HUES}" x="{left:.1f}" y="{top:.1f}" width="{width:.1f}" height="{ROW - 4}">')
            parts.append(f"<title>{escape(told)}</title></rect>")
            left += width
        parts.append(f'<text x="{left + 6:.1f}" y="{top + 14:.1f}">{totals[number]:.0f} {escape(curve.y)}</text>')
    return _picture(TOP + len(xs) * ROW * 1.3 + 8, parts) + _legend([each.who for each in curve.series])


def bars(comparison: Comparison) -> str:
    """Contenders over a logarithmic axis of time: a dot at the median, a stroke from quartile to quartile."""
    took = [each.took for each in comparison.figures]
    height = TOP + ROW * len(took) + BOTTOM / 2
    across = Scale.over([each.low for each in took] + [each.high for each in took], LABEL, WIDTH - RIGHT - 60)
    parts: list[str] = []
    for value in across.ticks():
        place = across.at(value)
        parts.append(f'<line class="grid" x1="{place:.1f}" x2="{place:.1f}" y1="{TOP}" y2="{height - BOTTOM / 2:.1f}"/>')
        parts.append(f'<text class="tick" x="{place:.1f}" y="{height - 6:.1f}">{words.time(value)}</text>')
    for number, (figure, cost) in enumerate(zip(comparison.figures, took, strict=True)):
        y, style = TOP + ROW * (number + 0.5), figure.role
        parts.append(f'<text class="name" x="{LABEL - 8}" y="{y + 4:.1f}">{escape(figure.who)}</text>')
        parts.append(f'<line class="{style} bar" x1="{across.at(cost.low):.1f}" x2="{across.at(cost.high):.1f}" y1="{y}" y2="{y}"/>')
        parts.append(f'<circle class="{style}" cx="{across.at(cost.median):.1f}" cy="{y}" r="4"/>')
        parts.append(f'<text x="{across.at(cost.high) + 8:.1f}" y="{y + 4:.1f}">{words.time(cost.median)}</text>')
    return _picture(height, parts)


def multiples(rows: Sequence[Row]) -> str:
    """Ratios over a logarithmic axis, as a file of its own: a dot for the median, a stroke for the quartiles, a tick for the target."""
    height = TOP + ROW * len(rows) + BOTTOM / 2
    costs = [row.measured for row in rows]
    wanted = [row.at_most for row in rows if row.at_most]
    across = Scale.over([1.0, *wanted, *(each.low for each in costs), *(each.high for each in costs)], WIDE_LABEL, WIDE - WIDE_NOTE)
    parts: list[str] = []
    for value in across.ticks():
        place, style = across.at(value), "one" if value == 1 else "grid"
        parts.append(f'<line class="{style}" x1="{place:.1f}" x2="{place:.1f}" y1="{TOP}" y2="{height - BOTTOM / 2:.1f}"/>')
        parts.append(f'<text class="tick" x="{place:.1f}" y="{height - 6:.1f}">{value:g}</text>')
    for number, (row, cost) in enumerate(zip(rows, costs, strict=True)):
        y = TOP + ROW * (number + 0.5)
        parts.append(f'<text class="name" x="{WIDE_LABEL - 8}" y="{y + 4:.1f}">{escape(row.what.replace("`", ""))}</text>')
        parts.append(f'<line class="ours bar" x1="{across.at(cost.low):.1f}" x2="{across.at(cost.high):.1f}" y1="{y}" y2="{y}"/>')
        parts.append(f'<circle class="ours" cx="{across.at(cost.median):.1f}" cy="{y}" r="4"/>')
        if row.at_most:
            place = across.at(row.at_most)
            parts.append(f'<line class="target" x1="{place:.1f}" x2="{place:.1f}" y1="{y - 7}" y2="{y + 7}"/>')
        parts.append(f'<text x="{WIDE - WIDE_NOTE + 12}" y="{y + 4:.1f}">{escape(f"{cost.median:.3g} {row.unit}")}</text>')
    style = f"<style>{ALONE}</style>"
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDE} {height:.0f}" width="{WIDE}">{style}{"".join(parts)}</svg>\n'


def _grid(across: Scale, up: Scale, x: str, y: str) -> Iterable[str]:
    for value in across.ticks():
        place = across.at(value)
        yield f'<line class="grid" x1="{place:.1f}" x2="{place:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>'
        yield f'<text class="tick" x="{place:.1f}" y="{HEIGHT - BOTTOM + 16}">{words.count(value)}</text>'
    for value in up.ticks():
        place = up.at(value)
        yield f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{place:.1f}" y2="{place:.1f}"/>'
        yield f'<text class="name" x="{LEFT - 6}" y="{place + 4:.1f}">{words.count(value)}</text>'
    yield f'<text class="tick" x="{(LEFT + WIDTH) / 2:.0f}" y="{HEIGHT - 8}">{escape(x)}</text>'
    yield f'<text class="tick" transform="translate(12 {HEIGHT / 2:.0f}) rotate(-90)">{escape(y)}</text>'


def _picture(height: float, parts: Sequence[str]) -> str:
    return f'<svg viewBox="0 0 {WIDTH} {height:.0f}" width="{WIDTH}" role="img">{"".join(parts)}</svg>'


def _legend(names: Sequence[str]) -> str:
    keys = (f'<span class="key"><i class="c{number % HUES}"></i>{escape(name)}</span>' for number, name in enumerate(names))
    return f'<p class="legend">{"".join(keys)}</p>'
