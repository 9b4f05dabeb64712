"""Measures contenders in turns, so that a busy moment of the machine hits all alike.

Absolute times do not travel between machines; how many `len()` or `memmove` a decode costs does, roughly. A contender is a function without
arguments that returns the nanoseconds a message took: Python's are timed here, native ones time their own loops. Time is the
thread's on a processor: while others have it, no clock runs.
"""

from __future__ import annotations

import time
import timeit
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

_Name = TypeVar("_Name")

PLACES = 5
"""Places of the data of one contender."""

STEP = 1376
"""Bytes by which the places are moved apart, about a third of a page."""


@dataclass(frozen=True, slots=True)
class Call:
    """A function with its arguments, called so many times a round, without anything in between.

    Attributes
    ----------
    idle
        Times the same loops with nothing in them.
    messages
        How many one call deals with.
    different
        How many of them are different: 1 if there is one, again and again; None where the job has none.
    """

    function: Callable[..., object]
    arguments: tuple[object, ...]
    timer: timeit.Timer
    count: int
    idle: timeit.Timer
    messages: int = 1
    different: int | None = 1

    def __call__(self) -> float:
        return 1e9 * self.timer.timeit(self.count) / (self.count * self.messages)

    def idle_ns(self) -> float:
        """What the loops alone take, a message."""
        return 1e9 * self.idle.timeit(self.count) / (self.count * self.messages)


@dataclass(slots=True)
class Placed:
    """One job on data in several places, in another one each round.

    Where two blocks lie modulo a page can make a copy ten times slower, and stays as it is for a process: in one place alone, a run
    would measure its luck.
    """

    calls: Sequence[Callable[[], float]]
    turn: int = 0

    def __call__(self) -> float:
        self.turn += 1
        return self.calls[self.turn % len(self.calls)]()

    @property
    def first(self) -> Callable[[], float]:
        """The job in one of its places."""
        return self.calls[0]


@dataclass(frozen=True, slots=True)
class Effort:
    """How long is measured: rounds, and seconds a contender in each of them."""

    rounds: int
    round_s: float
    quick: bool

    @classmethod
    def of(cls, *, quick: bool) -> Effort:
        return cls(7, 0.004, quick=True) if quick else cls(21, 0.02, quick=False)

    def in_turns(self, contenders: Mapping[_Name, Callable[[], float]], *, rounds: int | None = None) -> dict[_Name, tuple[float, ...]]:
        """Nanoseconds a message of each contender, a figure a round."""
        taken: dict[_Name, list[float]] = {name: [] for name in contenders}
        for timed in contenders.values():
            timed()  # caches, branch predictors, and lanes that grow
        for _ in range(rounds or self.rounds):
            for name, timed in contenders.items():
                taken[name].append(timed())
        return {name: tuple(values) for name, values in taken.items()}

    def call(
        self,
        function: Callable[..., object],
        *arguments: object,
        count: int | None = None,
        messages: int = 1,
        threaded: bool = False,
        clock: Callable[[], float] = time.thread_time,
        idle: Callable[..., object] | None = None,
        different: int | None = 1,
    ) -> Call:
        """A contender: a function that is called ``count`` times a round, or as often as fills one. Threads need a common clock.

        ``idle`` is what is left of a function that has a loop of its own, without the job.
        """
        names = [f"argument{number}" for number in range(len(arguments))]
        given = {"given_function": function, **{f"given_{name}": argument for name, argument in zip(names, arguments, strict=True)}}
        setup = "; ".join(f"{name} = given_{name}" for name in ("function", *names))
        chosen = time.perf_counter if threaded else clock
        timer = timeit.Timer(f"function({', '.join(names)})", setup, chosen, given)
        empty = timeit.Timer("pass", timer=chosen)
        if idle is not None:
            empty = timeit.Timer(f"function({', '.join(names)})", setup, chosen, {**given, "given_function": idle})
        return Call(function, arguments, timer, count or self._count(timer), empty, messages, different)

    def placed(self, place: Callable[[], Callable[[], float]]) -> Placed:
        """A contender that ``place`` makes, each time with data of its own."""
        calls: list[Callable[[], float]] = []
        between: list[bytearray] = []
        for number in range(PLACES):
            between.append(bytearray(STEP * number))
            calls.append(place())
        return Placed(calls)

    def _count(self, timer: timeit.Timer) -> int:
        """How many calls fill a round. The first call does not count: in it, peers write and compile their functions."""
        timer.timeit(1)
        count = 1
        while (took := timer.timeit(count)) < self.round_s / 4:
            count *= 4
        return max(1, int(count * self.round_s / took))
