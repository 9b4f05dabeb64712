"""`python -m bench.compare OLD.json NEW.json`: what changed beyond the noise.

It ends with 1 where a ratio that has a target got more than 15 % worse. Absolute times decide nothing: they tell of the machine. A
change is beyond the noise where the quartiles of both runs lie apart.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bench.figures import Row, from_json
from bench.report import words
from bench.report.markdown import table

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from bench.figures import Report

REGRESSION = 1.15
"""A ratio with a target that has grown by more than this factor is a regression."""


@dataclass(frozen=True, slots=True)
class Change:
    """One row in both runs."""

    old: Row
    new: Row

    @property
    def factor(self) -> float:
        return self.new.measured.median / self.old.measured.median

    @property
    def is_noise(self) -> bool:
        return self.old.measured.meets(self.new.measured)

    @property
    def is_regression(self) -> bool:
        return self.new.at_most is not None and self.factor > REGRESSION


def changes(old: Report, new: Report) -> tuple[Change, ...]:
    """The rows that both runs have."""
    before: Mapping[str, Row] = {row.what: row for row in old.rows}
    return tuple(Change(before[row.what], row) for row in new.rows if row.what in before)


def show(found: Sequence[Change]) -> str:
    """A table of what changed beyond the noise, the worst first; regressions are in it in any case."""
    told = [each for each in found if each.is_regression or not each.is_noise]
    lines = (
        (
            each.new.what,
            words.ratio(each.old.measured),
            f"{words.ratio(each.new.measured)} {each.new.unit}",
            f"{100 * (each.factor - 1):+.0f} %",
            "**regression**" if each.is_regression else "",
        )
        for each in sorted(told, key=lambda each: each.factor, reverse=True)
    )
    return table(("what", "old", "new", "change", ""), lines) if told else "nothing changed beyond the noise\n"


def missing(old: Report, new: Report) -> tuple[str, ...]:
    """The rows with a target that the new run does not have."""
    after = {row.what for row in new.rows}
    return tuple(row.what for row in old.rows if row.at_most is not None and row.what not in after)


def main(given: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="bench.compare", description="What changed between two runs, beyond the noise.")
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    asked = parser.parse_args(given)
    old, new = (from_json(json.loads(path.read_text("utf-8"))["rosetta_jit"]) for path in (asked.old, asked.new))
    found = changes(old, new)
    print(show(found), end="")
    for what in missing(old, new):
        print(f"not measured any more: {what}")
    return int(any(each.is_regression for each in found))


if __name__ == "__main__":
    sys.exit(main())
