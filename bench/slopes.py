"""How steep a curve is: the exponent with which a cost grows, fitted where the curve is longest, and whether the job explains it.

A cost of c·xᵏ is a line of slope k in logarithms. What is small is constant whatever it is, so the fit takes the upper half of the x.
"""

from __future__ import annotations

import math
import statistics
from dataclasses import replace

from bench.figures import Curve, Series, Spread

TOLERANCE = 0.15
"""By how much an exponent may exceed what the job has: caches end, and clocks are noisy."""


def exponent(series: Series) -> float:
    """The slope of the upper half of a series in logarithms; 0 where there are fewer than two points."""
    points = [(x, cost.median) for x, cost in series.points if x > 0 and cost.median > 0]
    upper = points[(len(points) - 1) // 2 :]
    if len(upper) < 2:
        return 0.0
    return statistics.linear_regression([math.log(x) for x, _ in upper], [math.log(y) for _, y in upper]).slope


def with_whole(curve: Curve) -> Curve:
    """A curve in parts with one series more, their sum; any other as it is."""
    if not curve.parts:
        return curve
    columns = zip(*(each.points for each in curve.series), strict=True)
    whole = Series("the whole", "ours", tuple((column[0][0], _sum([cost for _, cost in column])) for column in columns))
    return replace(curve, series=(*curve.series, whole))


def _sum(costs: list[Spread]) -> Spread:
    return Spread(sum(each.median for each in costs), sum(each.low for each in costs), sum(each.high for each in costs))


def too_steep(curve: Curve) -> tuple[str, ...]:
    """The series of ours that grow faster than their job, and faster than the physical limit does beside them."""
    allowed = max([curve.may_grow, *(exponent(each) for each in curve.series if each.role == "limit")]) + TOLERANCE
    return tuple(each.who for each in curve.series if each.role == "ours" and exponent(each) > allowed)
