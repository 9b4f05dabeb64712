"""What a run of the benchmarks finds, as data: it travels in pytest-benchmark's JSON, and every report is made from that file alone.

Report     = what was measured where: rows, comparisons, curves, memory
Row        = one ratio, perhaps with a target
Comparison = one job done by several contenders: ours, the physical limits, the peers
Curve      = how a cost grows: series of points over one quantity
"""

from __future__ import annotations

import statistics
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

Role = Literal["ours", "limit", "peer"]


@dataclass(frozen=True, slots=True)
class Spread:
    """A median and the quartiles around it.

    ``net``, of a ratio: the median of what is left when the loops around both are not counted; None where there are none.
    """

    median: float
    low: float
    high: float
    net: float | None = None

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """The middle of some values; one value is its own quartiles."""
        if len(values) == 1:
            return cls(values[0], values[0], values[0])
        low, median, high = statistics.quantiles(values, n=4, method="inclusive")
        return cls(median, low, high)

    def times(self, factor: float) -> Spread:
        return Spread(self.median * factor, self.low * factor, self.high * factor)

    def meets(self, other: Spread) -> bool:
        """Whether the quartiles of both overlap: such a difference is noise."""
        return self.low <= other.high and other.low <= self.high


def ratio(one: Sequence[float], other: Sequence[float]) -> Spread:
    """The ratio of two contenders that were measured in turns: of each round by itself, so that a busy moment hits both alike."""
    return Spread.of([a / b for a, b in zip(one, other, strict=True)])


def without(rounds: Sequence[float], idle: Sequence[float]) -> list[float]:
    """What is left of each round when the loop alone is not counted; no less than nothing."""
    return [max(all_ - loop, 0.0) for all_, loop in zip(rounds, idle, strict=True)]


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the README.

    ``at_most`` None: no target, the figure is only reported. ``against``: which of several the ratio was taken to, where that depends on
    what is installed. ``messages``: how many different ones came in turn; 1 of one that was repeated, None where there are none.
    ``family``: the module of benchmarks that it comes from. ``test``: the test in it, as pytest names it within `bench`.
    """

    what: str
    measured: Spread
    at_most: float | None
    unit: str  # of `measured` and `at_most`: "x len()", "ms", …
    detail: str = ""
    against: str = ""
    messages: int | None = None
    family: str = ""
    test: str = ""

    @property
    def met(self) -> bool:
        """Judged by the three digits that are shown: more than those, no run can tell from the next."""
        return self.at_most is None or float(f"{self.measured.median:.3g}") <= self.at_most


@dataclass(frozen=True, slots=True)
class Figure:
    """What one contender took: nanoseconds a message, a round each. ``makes`` says what it leaves behind: an object, anew or used again."""

    who: str
    role: Role
    makes: str
    rounds_ns: tuple[float, ...]

    @property
    def took(self) -> Spread:
        return Spread.of(self.rounds_ns)


@dataclass(frozen=True, slots=True)
class Comparison:
    """One job, done by all contenders in turns. Ours come first."""

    chapter: str
    title: str
    figures: tuple[Figure, ...]


def chapters(comparisons: Sequence[Comparison]) -> dict[str, list[Comparison]]:
    """The comparisons by chapter, in the order in which they were made."""
    found: dict[str, list[Comparison]] = {}
    for each in comparisons:
        found.setdefault(each.chapter, []).append(each)
    return found


@dataclass(frozen=True, slots=True)
class Series:
    """One line of a curve: (x, cost), costs positive."""

    who: str
    role: Role
    points: tuple[tuple[float, Spread], ...]


@dataclass(frozen=True, slots=True)
class Curve:
    """How a cost grows. ``may_grow``: the exponent that the job itself has: 1 where there is proportionally more to do.

    The series of curves in ``parts`` add up to the whole.
    """

    title: str
    x: str
    y: str
    series: tuple[Series, ...]
    may_grow: float = 1.0
    note: str = ""
    parts: bool = False


@dataclass(frozen=True, slots=True)
class Report:
    """One run."""

    rows: tuple[Row, ...]
    comparisons: tuple[Comparison, ...]
    curves: tuple[Curve, ...]


def to_json(report: Report) -> dict[str, Any]:
    """A report as JSON holds it."""
    return asdict(report)


def from_json(data: Mapping[str, Any]) -> Report:
    """The report that `to_json` wrote."""
    return Report(
        tuple(
            Row(
                *(each["what"], _spread(each["measured"]), each["at_most"], each["unit"], each["detail"]),
                against=each.get("against", ""),
                messages=each.get("messages"),
                family=each.get("family", ""),
                test=each.get("test", ""),
            )
            for each in data["rows"]
        ),
        tuple(Comparison(each["chapter"], each["title"], tuple(map(_figure, each["figures"]))) for each in data["comparisons"]),
        tuple(map(_curve, data["curves"])),
    )


def _spread(data: Mapping[str, Any]) -> Spread:
    return Spread(float(data["median"]), float(data["low"]), float(data["high"]), data.get("net"))


def _figure(data: Mapping[str, Any]) -> Figure:
    return Figure(data["who"], data["role"], data["makes"], tuple(map(float, data["rounds_ns"])))


def _curve(data: Mapping[str, Any]) -> Curve:
    series = tuple(
        Series(each["who"], each["role"], tuple((float(x), _spread(cost)) for x, cost in each["points"])) for each in data["series"]
    )
    return Curve(data["title"], data["x"], data["y"], series, data["may_grow"], data["note"], data["parts"])
