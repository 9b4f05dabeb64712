"""The tables of a run as rows of text, which Markdown and HTML both show: targets, who took how long, how costs grow."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.figures import ratio
from bench.report import words
from bench.slopes import exponent, too_steep, with_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from bench.figures import Comparison, Curve, Figure, Row, Series, Spread

Line = tuple[str, ...]

TARGETS: Line = ("what", "measured", "at most", "", "")
GROWTH: Line = ("of", "reach", "grows as", "")


def target(row: Row) -> Line:
    """A row against its target."""
    at_most = "" if row.at_most is None else f"{row.at_most:.3g} {row.unit}"
    mark = "" if row.at_most is None else "met" if row.met else "missed"
    detail = "; ".join(each for each in (row.detail, words.messages(row.messages)) if each)
    return row.what, f"{words.ratio(row.measured)} {row.unit}", at_most, mark, detail


def contenders(comparison: Comparison) -> tuple[Line, Sequence[Line]]:
    """One job: head and lines. Each of ours is given as a multiple of each limit and peer; where none is ours, each of the first one."""
    figures = comparison.figures
    ours = [each for each in figures if each.role == "ours"]
    compared = [f"{each.who}, as a multiple" for each in ours] or [f"as a multiple of {figures[0].who}"]
    lines = [(each.who, each.makes, words.spread_of_time(each.took), *_ratios(each, ours, figures[0])) for each in figures]
    return ("who", "makes", "median (quartiles)", *compared), lines


def _ratios(figure: Figure, ours: Sequence[Figure], first: Figure) -> Iterator[str]:
    for one, other in [(each, figure) for each in ours] or [(figure, first)]:
        yield "" if one is other or figure.role == "ours" else words.ratio(ratio(one.rounds_ns, other.rounds_ns))


def shares(curve: Curve) -> tuple[Line, Sequence[Line]]:
    """What each series of a curve in parts has of the whole, at each x."""
    *parts, whole = with_whole(curve).series
    head = ("share of", *(f"{words.count(x)} {curve.x}" for x, _ in whole.points))
    lines = [(each.who, *(f"{100 * part.median / all_.median:.0f} %" for part, all_ in _costs(each, whole))) for each in parts]
    return head, [*lines, (whole.who, *(f"{words.number(cost.median)} {curve.y}" for _, cost in whole.points))]


def _costs(one: Series, other: Series) -> Iterator[tuple[Spread, Spread]]:
    return zip((cost for _, cost in one.points), (cost for _, cost in other.points), strict=True)


def growth(curve: Curve) -> Iterator[Line]:
    """The exponent of each series, and what grows faster than its job."""
    whole = with_whole(curve)
    steep = too_steep(whole)
    for each in whole.series:
        (first, lowest), (last, highest) = each.points[0], each.points[-1]
        costs = f"{words.number(lowest.median)} to {words.number(highest.median)} {curve.y}"
        reach = f"{words.count(first)} to {words.count(last)} {curve.x}: {costs}"
        mark = f"steeper than the job, which is x^{curve.may_grow:g}" if each.who in steep else ""
        yield each.who, reach, f"x^{exponent(each):.2f}", mark
