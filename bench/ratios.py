"""Ratios of two durations that were measured in turns, so that a busy moment of the machine hits both alike.

Absolute times do not travel between machines; how many `len()` or `memmove` a decode costs does, roughly.
"""

from __future__ import annotations

import json
import timeit
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

ROUND_S = 0.02
ROUNDS = 15


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the report. ``at_most`` None: no target, the figure is only reported."""

    what: str
    measured: float
    at_most: float | None
    unit: str  # of `measured` and `at_most`: "x len()", "ms", …
    detail: str = ""

    @property
    def met(self) -> bool:
        return self.at_most is None or self.measured <= self.at_most


def best_ns(subjects: Mapping[str, Callable[[], object]], *, rounds: int = ROUNDS) -> dict[str, float]:
    """The shortest nanoseconds a call of each subject, all measured in turns; the loop around a call, a few ns, is in all of them."""
    timers = {name: timeit.Timer("subject()", "subject = s", globals={"s": subject}) for name, subject in subjects.items()}
    return _best(timers, rounds)


def best_call_ns(subjects: Mapping[str, tuple[Callable[..., object], object]], *, rounds: int = ROUNDS) -> dict[str, float]:
    """The same for functions of one argument, called without anything in between."""
    timers = {
        name: timeit.Timer("function(argument)", "function, argument = f, a", globals={"f": function, "a": argument})
        for name, (function, argument) in subjects.items()
    }
    return _best(timers, rounds)


def _best(timers: Mapping[str, timeit.Timer], rounds: int) -> dict[str, float]:
    counts = {name: _count(timer) for name, timer in timers.items()}
    best = dict.fromkeys(timers, float("inf"))
    for _ in range(rounds):
        for name, timer in timers.items():
            best[name] = min(best[name], 1e9 * timer.timeit(counts[name]) / counts[name])
    return best


def _count(timer: timeit.Timer) -> int:
    """How many calls fill a round."""
    count = 1
    while (took := timer.timeit(count)) < ROUND_S / 4:
        count *= 4
    return max(1, int(count * ROUND_S / took))


def markdown(rows: Sequence[Row]) -> str:
    """The table of the README."""
    lines = ["| what | measured | at most | |", "|---|---|---|---|"]
    for row in rows:
        target = "" if row.at_most is None else f"{row.at_most:.3g} {row.unit}"
        mark = "" if row.at_most is None else "met" if row.met else "**missed**"
        lines.append(
            f"| {row.what} | {row.measured:.3g} {row.unit} | {target} | {mark}{' - ' if mark and row.detail else ''}{row.detail} |"
        )
    return "\n".join(lines) + "\n"


def write_report(rows: Sequence[Row], folder: Path) -> None:
    """`report.md` and `report.json` in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "report.md").write_text(markdown(rows))
    (folder / "report.json").write_text(json.dumps([{**asdict(row), "met": row.met} for row in rows], indent=2))


def insert_in_readme(rows: Sequence[Row], readme: Path) -> None:
    """Replace what stands between the two marks."""
    text = readme.read_text()
    head, begin, rest = text.partition("<!-- speed: written by `make bench` -->\n")
    _, end, tail = rest.partition("<!-- speed: end -->")
    if begin and end:
        readme.write_text(f"{head}{begin}{markdown(rows)}{end}{tail}")
