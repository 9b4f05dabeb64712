"""Collects the rows of all benchmarks, prints the table, and fails where a target is missed unless only a report is wanted."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.peers import Peers
from bench.ratios import Row, insert_in_readme, markdown, write_report

ROOT = Path(__file__).resolve().parent.parent
ROWS = pytest.StashKey[list[Row]]()


def pytest_addoption(parser):
    parser.addoption("--bench-report", action="store_true", help="missed targets are shown and do not fail the run")
    parser.addoption("--bench-readme", action="store_true", help="write the table into README.md")


def pytest_configure(config):
    config.stash[ROWS] = []


@pytest.fixture
def record(request):
    """Call it with the fields of a `Row`: the row joins the report, and its target is demanded unless only a report is wanted."""

    def record_row(what, measured, at_most, unit, detail=""):
        row = Row(what, measured, at_most, unit, detail)
        request.config.stash[ROWS].append(row)
        if not request.config.getoption("--bench-report"):
            assert row.met, f"{what}: {measured:.3g} {unit}, at most {at_most:.3g} wanted"

    return record_row


@pytest.fixture(scope="session")
def peers():
    return Peers(ROOT / "build" / "native" / "libpeers.so")


def pytest_terminal_summary(terminalreporter, config):
    rows = config.stash[ROWS]
    if not rows:
        return
    terminalreporter.write_sep("=", "targets")
    terminalreporter.write(markdown(rows))
    write_report(rows, ROOT / "build" / "bench")
    if config.getoption("--bench-readme"):
        insert_in_readme(rows, ROOT / "README.md")
