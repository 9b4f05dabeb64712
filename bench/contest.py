"""Who competes for one job, and what came out: the contenders are measured in turns, and ratios are taken round by round."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.figures import Comparison, Figure, Role, Spread, ratio

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from bench.turns import Effort


@dataclass(frozen=True, slots=True)
class Contender:
    """One way to do the job. ``timed`` gives the nanoseconds a message of one round."""

    who: str
    role: Role
    makes: str
    timed: Callable[[], float]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What the rounds gave, by contender."""

    rounds_ns: Mapping[str, tuple[float, ...]]

    def took(self, who: str) -> Spread:
        return Spread.of(self.rounds_ns[who])

    def ratio(self, who: str, other: str) -> Spread:
        return ratio(self.rounds_ns[who], self.rounds_ns[other])

    def fastest(self, names: Sequence[str]) -> str:
        return min(names, key=lambda name: self.took(name).median)


def held(effort: Effort, contenders: Sequence[Contender], *, rounds: int | None = None) -> Outcome:
    """Measure them in turns."""
    return Outcome(effort.in_turns({each.who: each.timed for each in contenders}, rounds=rounds))


def comparison(chapter: str, title: str, contenders: Sequence[Contender], outcome: Outcome) -> Comparison:
    """The outcome as the report has it."""
    figures = tuple(Figure(each.who, each.role, each.makes, outcome.rounds_ns[each.who]) for each in contenders)
    return Comparison(chapter, title, figures)
