"""Collects what the benchmarks find for pytest-benchmark's JSON, and fails where a target is missed unless only a report is wanted."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench import contest
from bench.figures import Curve, Report, Row, to_json
from bench.machine import versions
from bench.report.markdown import targets
from bench.report.readme import write_in
from bench.turns import Effort

ROOT = Path(__file__).resolve().parent.parent
ORDER = (
    "native_bottle",
    "native_image",
    "reorder",
    "groups",
    "state",
    "wires",
    "filters",
    "lookup",
    "flags",
    "sums",
    "left_alone",
    "parts",
    "reductions",
    "mapped",
    "bridges",
    "peers",
    "against_cpp",
    "generated",
    "classes",
    "attributes",
    "reading",
    "building",
    "manners",
    "columns",
    "numba",
    "logs",
    "large_logs",
    "start",
    "compile",
    "memory",
    "limits",
    "curves",
)
"""The modules as they are run and reported: what users ask first comes first."""

FOUND = pytest.StashKey[dict[str, list]]()
MESSAGES = pytest.StashKey[int | None]()
"""How many different messages the last comparison of a test was of, as a `Row` has it."""


def pytest_addoption(parser):
    parser.addoption("--quick", action="store_true", help="few and short rounds, small curves: a look, in minutes")
    parser.addoption("--bench-report", action="store_true", help="missed targets are shown and do not fail the run")
    parser.addoption("--planted", action="store_true", help="with a loop planted in all compiled code: is it told?")
    parser.addoption(
        "--bench-readme",
        action="store_true",
        help="write rows and their picture into README.md, and docs/benchmarks.md",
    )


def pytest_configure(config):
    if config.getoption("--planted"):
        from bench.planting import plant  # before the modules of benchmarks are imported

        plant()
    config.stash[FOUND] = {"rows": [], "comparisons": [], "curves": []}


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: ORDER.index(item.path.stem.removeprefix("test_")))


def pytest_benchmark_update_json(config, output_json):
    output_json["rosetta_jit"] = {**to_json(_report(config)), "quick": config.getoption("--quick"), "versions": versions()}


def pytest_terminal_summary(terminalreporter, config):
    report = _report(config)
    if not report.rows:
        return
    terminalreporter.write_sep("=", "targets")
    terminalreporter.write(targets(report.rows))
    if config.getoption("--bench-readme"):
        write_in(ROOT, report.rows)


def _report(config):
    return Report(**{name: tuple(found) for name, found in config.stash[FOUND].items()})


@pytest.fixture(scope="session")
def effort(request):
    return Effort.of(quick=request.config.getoption("--quick"))


@pytest.fixture
def record(request, found):
    """Call it with the fields of a `Row`: the row joins the report, and its target is demanded unless only a report is wanted.

    ``messages`` are told where nothing was compared by `compare`, which knows them.
    """

    def record_row(what, measured, at_most, unit, detail="", against="", *, messages=None):
        family, test = request.node.path.stem.removeprefix("test_"), request.node.nodeid.removeprefix("bench/")
        row = Row(what, measured, at_most, unit, detail, against, request.node.stash.get(MESSAGES, messages), family, test)
        found("rows", row)
        if not request.config.getoption("--bench-report"):
            assert row.met, f"{what}: {measured.median:.3g} {unit}, at most {at_most:.3g} wanted"

    return record_row


@pytest.fixture
def compare(request, found, effort, benchmark):
    """Call it with a chapter, a title and contenders, ours first: the comparison joins the report, and ours pytest-benchmark's own."""

    def measure(chapter, title, contenders, *, rounds=None):
        outcome = contest.held(effort, contenders, rounds=rounds)
        found("comparisons", contest.comparison(chapter, title, contenders, outcome))
        ours = contest.call_of(contenders[0].timed)
        assert ours is not None
        request.node.stash[MESSAGES] = ours.different
        benchmark.group = chapter
        benchmark.extra_info.update({who: outcome.took(who).median for who in outcome.rounds_ns})
        benchmark.pedantic(ours.function, ours.arguments, rounds=5, iterations=max(1, ours.count // 5))
        return outcome

    return measure


@pytest.fixture
def found(request):
    """Call it with `rows`, `comparisons` or `curves` and one of them: it joins the report."""
    return lambda kind, each: request.config.stash[FOUND][kind].append(each)


@pytest.fixture
def draw(found):
    """Call it with the fields of a `Curve`, which joins the report."""
    return lambda *arguments, **options: found("curves", Curve(*arguments, **options))
