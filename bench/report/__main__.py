"""`python -m bench.report RUN.json [--output FOLDER] [--keep]`: writes report.md and report.html from a run's JSON."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from bench import baseline
from bench.report import html, markdown
from bench.run import Run, RunError, read

if TYPE_CHECKING:
    from collections.abc import Sequence


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="bench.report", description="Write report.md and report.html from a run's JSON.")
    parser.add_argument("run", type=Path, help="build/bench/run.json, or one of those kept in build/bench/runs")
    parser.add_argument("--output", type=Path, help="folder; that of the run by default")
    parser.add_argument("--keep", action="store_true", help="keep its rows in bench/baseline, too, which `make bench-check` compares with")
    asked = parser.parse_args(words)
    folder: Path = asked.output or asked.run.parent
    try:
        run = read(asked.run)
    except RunError as error:
        print(f"bench.report: {error}", file=sys.stderr)
        return 2
    write(run, folder)
    if asked.keep:
        baseline.keep(asked.run)
    print(f"{folder / 'report.html'}\n{folder / 'report.md'}")
    return 0


def write(run: Run, folder: Path) -> None:
    """Both reports of a run, into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "report.md").write_text(markdown.page(run.report, run.about), "utf-8")
    (folder / "report.html").write_text(html.page(run.report, run.about), "utf-8")


if __name__ == "__main__":
    sys.exit(main())
