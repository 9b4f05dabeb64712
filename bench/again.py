"""`python -m bench.again CHECKOUT TEST…`: what benchmarks find in another checkout and in this one, measured by turns.

Two runs apart tell of two moments of the machine, and one process of where its data came to lie: copies of much memory have two speeds. So
each turn is a process of the other checkout and one of this one, each with its own benchmarks, and a row is slower where it is so turn by
turn. The other checkout needs its native peers (`make native`). TEST is a test of `bench`, as `test_peers.py::test_decode[Imu]`.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from bench.figures import Spread, from_json, ratio
from bench.processes import SURROUNDINGS
from bench.report import words
from bench.report.markdown import table
from bench.run import RunError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from bench.figures import Report, Row

HERE = Path(__file__).resolve().parent.parent
BESIDE = HERE / "bench" / "beside"
"""Where the plugin lies that keeps what the benchmarks of any checkout find."""

TURNS = 7
"""Processes of each checkout."""

RESOLUTION = 0.02
"""A smaller part more is as much."""


@dataclass(frozen=True, slots=True)
class Pairs:
    """One quantity in the other checkout and in this one, a pair of figures a turn."""

    old: tuple[float, ...]
    new: tuple[float, ...]

    @property
    def factor(self) -> Spread:
        """New by old, of each turn by itself."""
        return ratio(self.new, self.old)

    @property
    def grew(self) -> bool:
        """Whether it is more in three of four turns, and at its best: that no process of this checkout had the other's luck is no luck."""
        return self.factor.low > 1 + RESOLUTION and min(self.new) > (1 + RESOLUTION) * min(self.old)


@dataclass(frozen=True, slots=True)
class Again:
    """One row by turns, and the times of ours that its test has measured: many a row is a ratio to what may have become faster."""

    row: Row
    figures: Pairs
    times_ns: Mapping[str, Pairs] = field(default_factory=dict[str, Pairs])

    @property
    def is_slower(self) -> bool:
        """Where the figure grew, and a time of ours with it, if there is one."""
        return self.figures.grew and (not self.times_ns or any(each.grew for each in self.times_ns.values()))


def paired(old: Sequence[Report], new: Sequence[Report]) -> tuple[Again, ...]:
    """The rows that all turns have."""
    times = _pairs([_times_ns(report) for report in old], [_times_ns(report) for report in new])
    figures = _pairs([_figures(report) for report in old], [_figures(report) for report in new])
    return tuple(Again(row, figures[row.what], times) for row in new[-1].rows if row.what in figures)


def _pairs(old: Sequence[Mapping[str, float]], new: Sequence[Mapping[str, float]]) -> dict[str, Pairs]:
    return {
        name: Pairs(tuple(each[name] for each in old), tuple(each[name] for each in new))
        for name in new[-1]
        if all(each.get(name, 0) > 0 for each in (*old, *new))
    }


def _figures(report: Report) -> dict[str, float]:
    return {row.what: row.measured.median for row in report.rows}


def _times_ns(report: Report) -> dict[str, float]:
    return {
        f"{each.title}: {figure.who}": figure.took.median for each in report.comparisons for figure in each.figures if figure.role == "ours"
    }


def by_turns(checkout: Path, test: str, *, turns: int = TURNS) -> tuple[Again, ...]:
    """What a test finds in another checkout and in this one.

    Raises
    ------
    RunError
        One of them does not have the test, or it does not run there.
    """
    found: dict[Path, list[Report]] = {checkout: [], HERE: []}
    for turn in range(turns):
        for each in (checkout, HERE)[:: 1 if turn % 2 == 0 else -1]:  # who comes second finds a warmer machine
            found[each].append(measured(each, test))
    return paired(found[checkout], found[HERE])


def measured(checkout: Path, test: str) -> Report:
    """What a test finds in a new process of a checkout."""
    if not (checkout / "bench" / test.partition("::")[0]).exists():
        raise RunError(f"{checkout}: has no bench/{test}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "report.json")
        surroundings = {**SURROUNDINGS, "PYTHONPATH": os.pathsep.join((str(checkout), str(BESIDE))), "KEPT_REPORT": str(path)}
        command = [sys.executable, "-m", "pytest", "-p", "kept_report", f"bench/{test}", "--quick", "--bench-report"]
        ran = subprocess.run(command, cwd=checkout, env=surroundings, check=False, capture_output=True, text=True)
        if not path.exists() or ran.returncode:
            said = (ran.stdout + ran.stderr).strip().splitlines()
            why = ([line for line in said if "error" in line.lower()] or said)[-1:]
            raise RunError(f"{checkout}: bench/{test} does not run: {' '.join(why)}")
        return from_json(json.loads(path.read_text("utf-8")))


def show(found: Iterable[Again]) -> str:
    """A table of rows by turns, and below it the times of ours."""
    found = tuple(found)
    times = {name: pairs for each in found for name, pairs in each.times_ns.items()}
    return "".join(
        (
            table(
                ("by turns", "old", "new", "change", ""),
                (_line(each.row.what, each.figures, each.row.unit, each.is_slower) for each in found),
            ),
            *(["\n", table(("time of ours", "old", "new", "change", ""), _time_lines(times))] if times else []),
        )
    )


def _line(what: str, pairs: Pairs, unit: str, is_slower: bool) -> tuple[str, ...]:
    return (
        what,
        words.ratio(Spread.of(pairs.old)),
        f"{words.ratio(Spread.of(pairs.new))} {unit}",
        change(pairs),
        "**slower**" if is_slower else "",
    )


def _time_lines(times: Mapping[str, Pairs]) -> Iterator[tuple[str, ...]]:
    for name, pairs in times.items():
        yield name, *(words.spread_of_time(Spread.of(each)) for each in (pairs.old, pairs.new)), change(pairs), "grew" if pairs.grew else ""


def change(pairs: Pairs) -> str:
    """`+5 % (+3 to +8)`: the median of the turns, and their quartiles."""
    middle, low, high = (100 * (each - 1) for each in (pairs.factor.median, pairs.factor.low, pairs.factor.high))
    return f"{middle:+.0f} % ({low:+.0f} to {high:+.0f})"


def main(given: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="bench.again", description="Benchmarks of another checkout and of this one by turns. Ends with 1 where a row is slower here."
    )
    parser.add_argument("checkout", type=Path, help="the folder of the other one")
    parser.add_argument("test", nargs="+", help="as test_peers.py::test_decode[Imu]")
    parser.add_argument("--turns", type=int, default=TURNS, help=f"processes of each ({TURNS})")
    asked = parser.parse_args(given)
    slower = False
    for test in asked.test:
        try:
            found = by_turns(asked.checkout.resolve(), test, turns=asked.turns)
        except RunError as error:
            print(f"bench.again: {error}", file=sys.stderr)
            return 2
        print(show(found), flush=True)
        slower = slower or any(each.is_slower for each in found)
    return int(slower)


if __name__ == "__main__":
    sys.exit(main())
