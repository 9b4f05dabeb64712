"""`python -m bench.compare OLD.json… NEW.json`: what changed beyond the noise.

It ends with 1 where a ratio that has a target got more than 15 % worse, and with 2 where a file is no run. Absolute times decide nothing:
they tell of the machine. A change is beyond the noise where the quartiles of both runs lie apart. Quartiles tell of the noise within
a process; that between processes (where the memory of a holder came to lie) shows where several old runs of one version are given, whose
spread is that of all. Where the old run is a checkout, its last run is meant, and what seems slower in it is measured again by turns
(`bench.again`): only what is slower by turns counts then, by however little.
"""

from __future__ import annotations

import argparse
import statistics
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from bench.again import TURNS, Again, by_turns
from bench.again import show as show_turns
from bench.figures import Row, Spread
from bench.report import words
from bench.report.markdown import table
from bench.run import Run, RunError, read

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

LAST_RUN = Path("build", "bench", "run.json")
"""Where a checkout has the run that was made last."""

REGRESSION = 1.15
"""A ratio with a target that has grown by more than this factor is a regression."""

RESOLUTION = 0.02
"""Changes of a smaller part are not told, however narrow the quartiles are."""

OF_THE_MOMENT = frozenset({"when", "commit", "load average"})
"""What differs between any two runs."""


@dataclass(frozen=True, slots=True)
class Change:
    """One row in both runs."""

    old: Row
    new: Row

    @property
    def factor(self) -> float:
        """New by old; 1 where the old one is no quantity that can grow in proportion."""
        old = self.old.measured.median
        return self.new.measured.median / old if old > 0 else 1.0

    @property
    def is_noise(self) -> bool:
        return self.old.measured.meets(self.new.measured) or abs(self.factor - 1) < RESOLUTION

    @property
    def is_regression(self) -> bool:
        """Of a target, by more than is allowed, to where the old runs rarely were."""
        return self.new.at_most is not None and self.factor > REGRESSION and self.new.measured.median > self.old.measured.high

    @property
    def seems_slower(self) -> bool:
        """Whether a row with a target is worse beyond the noise of its processes, by however little."""
        return self.is_regression or (self.new.at_most is not None and self.factor > 1 and not self.is_noise)

    @property
    def is_comparable(self) -> bool:
        """Whether both are ratios to the same; old files do not say to what."""
        return not self.old.against or not self.new.against or self.old.against == self.new.against


def together(runs: Sequence[Sequence[Row]]) -> tuple[Row, ...]:
    """The rows of several runs of one version: the median of their medians, between the lowest and the highest quartile."""
    by_name: dict[str, list[Row]] = {}
    for row in (row for rows in runs for row in rows):
        by_name.setdefault(row.what, []).append(row)
    return tuple(replace(rows[-1], measured=_across([row.measured for row in rows])) for rows in by_name.values())


def _across(spreads: Sequence[Spread]) -> Spread:
    median = statistics.median(each.median for each in spreads)
    return Spread(median, min(each.low for each in spreads), max(each.high for each in spreads))


def changes(old: Iterable[Row], new: Iterable[Row]) -> tuple[Change, ...]:
    """The rows that both have."""
    before: Mapping[str, Row] = {row.what: row for row in old}
    return tuple(Change(before[row.what], row) for row in new if row.what in before)


def show(found: Sequence[Change]) -> str:
    """A table of what changed beyond the noise, the worst first; regressions are in it in any case."""
    told = [each for each in found if each.is_regression or not each.is_noise]
    lines = (
        (
            each.new.what,
            words.ratio(each.old.measured),
            f"{words.ratio(each.new.measured)} {each.new.unit}",
            f"{100 * (each.factor - 1):+.0f} %",
            "**regression**" if each.is_regression else "" if each.new.at_most is None else "has a target",
        )
        for each in sorted(told, key=lambda each: each.factor, reverse=True)
    )
    return table(("what", "old", "new", "change", ""), lines) if told else "nothing changed beyond the noise\n"


def remarks(old: Run, before: Sequence[Row], new: Run, found: Sequence[Change]) -> Iterator[str]:
    """What the table does not say: how the runs differ, and which rows only one of them has."""
    for name in sorted({*old.about, *new.about} - OF_THE_MOMENT):
        one, other = (run.about.get(name, "not told") for run in (old, new))
        if one != other:
            yield f"the runs differ in {name}: {one} -> {other}"
    for each in found:
        if not each.is_comparable:
            yield f"not compared, a ratio to something else: {each.new.what}: {each.old.against} -> {each.new.against}"
    after, known = {row.what for row in new.report.rows}, {row.what for row in before}
    for row in before:
        if row.what not in after:
            yield f"not measured any more: {row.what}{'' if row.at_most is None else ', which has a target'}"
    for row in new.report.rows:
        if row.what not in known:
            yield f"new: {row.what}: {words.ratio(row.measured)} {row.unit}"


def suspects(found: Iterable[Change]) -> dict[str, list[str]]:
    """The rows that seem slower, by the tests that measure them; those of runs whose rows do not name their tests, by their modules."""
    by_test: dict[str, list[str]] = {}
    for row in (each.new for each in found if each.seems_slower):
        by_test.setdefault(row.test or f"test_{row.family}.py", []).append(row.what)
    return by_test


def measured_again(checkout: Path, found: Sequence[Change], turns: int) -> set[str]:
    """Show by turns what seems slower; the rows that are. What cannot be measured again is slower where it is a regression."""
    slower = {each.new.what for each in found if each.is_regression}
    for test, rows in suspects(found).items():
        try:
            again: list[Again] = [each for each in by_turns(checkout, test, turns=turns) if each.row.what in rows]
        except RunError as error:
            print(f"\nnot measured again: {', '.join(rows)}: {error}")
            continue
        print(f"\n{show_turns(again)}", end="", flush=True)
        slower = slower.difference(each.row.what for each in again) | {each.row.what for each in again if each.is_slower}
    return slower


def compared(olds: Sequence[Run], new: Run) -> list[Change]:
    """Show what changed beyond the noise; the changes of all rows that are ratios to the same."""
    before = together([run.report.rows for run in olds])
    found = changes(before, new.report.rows)
    comparable = [each for each in found if each.is_comparable]
    print(show(comparable), end="")
    for remark in remarks(olds[-1], before, new, found):
        print(remark)
    return comparable


def main(given: Sequence[str] | None = None) -> int:
    asked = _parser().parse_args(given)
    try:
        olds, new = [read(path / LAST_RUN if path.is_dir() else path) for path in asked.old], read(asked.new)
    except RunError as error:
        print(f"bench.compare: {error}", file=sys.stderr)
        return 2
    if asked.same_machine:
        others = {run.about["machine"] for run in olds} - {new.about["machine"]}
        olds = [run for run in olds if run.about["machine"] not in others]
        if others:
            print(f"not compared with runs of {', '.join(sorted(others))}")
        if not olds:
            return 0
    found = compared(olds, new)
    checkout = next((path for path in (asked.again, *asked.old) if path is not None and path.is_dir()), None)
    if checkout is None:
        return int(any(each.is_regression for each in found))
    return int(bool(measured_again(checkout.resolve(), found, asked.turns)))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="bench.compare",
        description="What changed between runs, beyond the noise. Ends with 1 where a ratio that has a target got more than 15 % worse, "
        "or by turns is worse at all.",
    )
    parser.add_argument(
        "old",
        type=Path,
        nargs="+",
        help="a run's JSON; several of one version tell how much runs vary; a checkout's folder means its last run, and --again",
    )
    parser.add_argument("new", type=Path, help="the JSON of the run that is judged")
    parser.add_argument("--again", type=Path, metavar="CHECKOUT", help="measure what seems slower again, by turns with this checkout")
    parser.add_argument("--turns", type=int, default=TURNS, help=f"processes of each checkout ({TURNS})")
    parser.add_argument(
        "--same-machine", action="store_true", help="leave out old runs of other machines, and end with 0 where none is left"
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
