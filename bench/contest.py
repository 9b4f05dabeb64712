"""Who competes for one job, and what came out: the contenders are measured in turns, and ratios are taken round by round."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from bench.figures import Comparison, Figure, Role, Spread, ratio, without
from bench.turns import Call, Placed

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
    idle_ns: Mapping[str, tuple[float, ...]] = field(default_factory=dict[str, "tuple[float, ...]"])
    """What the loops of those took that are timed in loops of Python's."""

    def took(self, who: str) -> Spread:
        return Spread.of(self.rounds_ns[who])

    def ratio(self, who: str, other: str) -> Spread:
        gross, ours, theirs = ratio(self.rounds_ns[who], self.rounds_ns[other]), self._net(who), self._net(other)
        if self.idle_ns.keys().isdisjoint((who, other)) or not all(theirs):
            return gross
        return replace(gross, net=ratio(ours, theirs).median)

    def _net(self, who: str) -> Sequence[float]:
        return without(self.rounds_ns[who], self.idle_ns[who]) if who in self.idle_ns else self.rounds_ns[who]

    def fastest(self, names: Sequence[str]) -> str:
        return min(names, key=lambda name: self.took(name).median)


def held(effort: Effort, contenders: Sequence[Contender], *, rounds: int | None = None) -> Outcome:
    """Measure them in turns."""
    calls = {each.who: call for each in contenders if (call := call_of(each.timed)) is not None}
    idle = {(who,): call.idle_ns for who, call in calls.items()}
    taken = effort.in_turns({**{each.who: each.timed for each in contenders}, **idle}, rounds=rounds)
    return Outcome({who: taken[who] for who in taken if isinstance(who, str)}, {who: taken[who,] for who in calls})


def call_of(timed: Callable[[], float]) -> Call | None:
    """The call from Python that a contender is, in one of its places; None of one that times itself."""
    call = timed.first if isinstance(timed, Placed) else timed
    return call if isinstance(call, Call) else None


def comparison(chapter: str, title: str, contenders: Sequence[Contender], outcome: Outcome) -> Comparison:
    """The outcome as the report has it."""
    figures = tuple(Figure(each.who, each.role, each.makes, outcome.rounds_ns[each.who]) for each in contenders)
    return Comparison(chapter, title, figures)
