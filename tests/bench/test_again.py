"""What seems slower between two runs is measured again by turns, and only what is slower turn by turn counts."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from bench import again, compare
from bench.again import HERE, Again, Pairs, by_turns, measured, paired
from bench.figures import Comparison, Figure, Report, to_json
from bench.run import RunError
from tests.bench import runs

ROW = replace(runs.row("decode", 1.5), test="test_peers.py::test_decode[Imu]")


def report(figure, own_ns=None, *, who="rosetta_jit", role="ours"):
    """A run of one test: a row, and what ours took."""
    figures = () if own_ns is None else (Comparison("Decoding", "Imu", (Figure(who, role, "", (own_ns,)),)),)
    return Report((replace(runs.row("decode", figure), test=ROW.test),), figures, ())


def verdict(old, new):
    (found,) = paired([report(*each) for each in old], [report(*each) for each in new])
    return found.is_slower


@pytest.mark.parametrize(
    ("old", "new", "grew"),
    [
        ([1.0] * 5, [1.1] * 5, True),
        ([1.0] * 5, [1.03] * 5, True),
        ([1.0] * 5, [1.01] * 5, False),
        ([1.0] * 5, [0.9] * 5, False),
        ([1.0, 1.3, 1.0, 1.3, 1.0], [1.3, 1.0, 1.3, 1.3, 1.3], False),  # copies of much memory have two speeds
        ([1.0, 1.3, 1.0, 1.0, 1.0], [1.3, 1.0, 1.3, 1.3, 1.3], False),  # as fast at their best
        ([1.0, 2.0, 3.0, 4.0, 5.0], [1.1, 2.2, 3.3, 4.4, 5.5], True),  # a machine that becomes slower: each turn by itself
        ([1.0, 1.0, 1.0, 1.0, 1.0], [1.0, 1.0, 1.3, 1.0, 1.3], False),
    ],
)
def test_what_grew_did_so_in_most_turns_and_at_its_best(old, new, grew):
    assert Pairs(tuple(old), tuple(new)).grew is grew


@pytest.mark.parametrize(
    ("old", "new", "slower"),
    [
        ((1.0, 20.0), (1.2, 24.0), True),
        ((0.8, 176.0), (0.85, 122.0), False),  # of its own decode, which became faster still
        ((1.2, 72.0), (1.3, 70.0), False),  # memmove was faster
        ((1.0, 20.0), (1.0, 24.0), False),  # no row: the machine
        ((1.0,), (1.2,), True),  # nothing else was measured
    ],
)
def test_a_ratio_counts_where_a_time_of_ours_grew_with_it(old, new, slower):
    assert verdict([old] * 5, [new] * 5) is slower


def test_times_of_peers_excuse_nothing():
    old, new = ([report(figure, 10.0, who="genpy", role="peer")] * 3 for figure in (1.0, 1.2))
    (found,) = paired(old, new)
    assert not found.times_ns
    assert found.is_slower


def test_rows_that_a_turn_lacks_are_left_out():
    assert paired([report(1.0), Report((), (), ())], [report(2.0)] * 2) == ()
    assert paired([report(0.0)], [report(2.0)]) == ()


def test_checkouts_take_turns(monkeypatch, tmp_path):
    """Who comes second finds a warmer machine: it is not always the same."""
    asked = []

    def measure(checkout, test):
        asked.append((checkout == HERE, test))
        return report(1.0 if checkout == tmp_path else 1.5)

    monkeypatch.setattr(again, "measured", measure)
    (found,) = by_turns(tmp_path, ROW.test, turns=3)
    assert [is_here for is_here, _ in asked] == [False, True, True, False, False, True]
    assert {test for _, test in asked} == {ROW.test}
    assert found.figures == Pairs((1.0,) * 3, (1.5,) * 3)


def test_a_checkout_measures_with_its_own_benchmarks(tmp_path):
    """In its folder, with its modules, in a new process; whether a test times a function by pytest-benchmark or not."""
    content = to_json(Report((replace(ROW, what="of the other"),), (), ()))
    (tmp_path / "bench").mkdir()
    (tmp_path / "bench" / "conftest.py").write_text(
        "import rosetta_jit\n"
        f"assert rosetta_jit.__file__.startswith({str(tmp_path)!r})\n"
        "def pytest_addoption(parser):\n"
        "    for flag in ('--quick', '--bench-report'):\n"
        "        parser.addoption(flag, action='store_true')\n"
        "def pytest_benchmark_update_json(output_json):\n"
        f"    output_json['rosetta_jit'] = {content!r}\n"
    )
    (tmp_path / "bench" / "test_peers.py").write_text("def test_decode():\n    pass\n")
    (tmp_path / "rosetta_jit").mkdir()
    (tmp_path / "rosetta_jit" / "__init__.py").touch()
    assert [row.what for row in measured(tmp_path, "test_peers.py").rows] == ["of the other"]
    with pytest.raises(RunError, match=r": has no bench/test_none.py$"):
        measured(tmp_path, "test_none.py")
    with pytest.raises(RunError, match=r"bench/test_peers.py::test_encode does not run: ERROR: not found: "):
        measured(tmp_path, "test_peers.py::test_encode")


@pytest.fixture
def compared(monkeypatch, tmp_path):
    """Compares a checkout's last run with a new one, with turns that are given: their figures, by row."""

    def compare_runs(old, new, turns):
        path = tmp_path / "other" / compare.LAST_RUN
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(runs.run(*old)))
        (tmp_path / "new.json").write_text(json.dumps(runs.run(*new)))

        def measure(checkout, test, *, turns: int):
            assert checkout == tmp_path / "other"
            if isinstance(given[test], Exception):
                raise given[test]
            return tuple(
                Again(row, Pairs((row.measured.median,) * turns, (factor * row.measured.median,) * turns)) for row, factor in given[test]
            )

        given = turns
        monkeypatch.setattr(compare, "by_turns", measure)
        return compare.main([str(tmp_path / "other"), str(tmp_path / "new.json")])

    return compare_runs


def named(name, median=1.5, **options):
    return replace(runs.row(name, median, **options), test=f"test_peers.py::test_decode[{name}]", family="peers")


def test_what_is_as_fast_by_turns_is_no_regression(compared, capsys):
    found = compared([named("a")], [named("a", 1.9)], {"test_peers.py::test_decode[a]": [(named("a"), 1.0)]})
    assert found == 0
    out = capsys.readouterr().out
    assert "| a | 1.5 (1.4 to 1.6) | 1.9 (1.8 to 2) x len() | +27 % | **regression** |" in out
    assert "| a | 1.5 (1.5 to 1.5) | 1.5 (1.5 to 1.5) x len() | +0 % (+0 to +0) |  |" in out


def test_what_is_slower_by_turns_counts_however_little(compared, capsys):
    """Without a regression in the runs, too."""
    old, new = named("a", width=0.01), named("a", 1.6, width=0.01)
    assert compared([old], [new], {old.test: [(old, 1.05)]}) == 1
    assert "| +5 % (+5 to +5) | **slower** |" in capsys.readouterr().out


def test_only_what_seems_slower_is_measured_again(compared):
    old = [named("faster"), named("the same"), named("free", at_most=None)]
    assert compared(old, [named("faster", 1.0), named("the same"), named("free", 9.0, at_most=None)], {}) == 0


def test_other_rows_of_the_test_do_not_count(compared, capsys):
    """They did not seem slower."""
    assert compared([named("a")], [named("a", 1.9)], {named("a").test: [(named("a"), 1.0), (named("b"), 1.5)]}) == 0
    assert "| b |" not in capsys.readouterr().out


def test_what_cannot_be_measured_again_is_as_the_runs_have_it(compared, capsys):
    error = RunError("/other: bench/test_peers.py does not run: no such test")
    old = [named("a"), named("b", width=0.01)]
    new = [named("a", 1.9), named("b", 1.6, width=0.01)]
    assert compared(old, new, {each.test: error for each in old}) == 1
    assert "not measured again: a: /other: bench/test_peers.py does not run: no such test" in capsys.readouterr().out
    assert compared(old[1:], new[1:], {old[1].test: error}) == 0


def test_rows_of_older_runs_are_found_by_their_module(compared):
    """Runs of before rows named their tests."""
    old, new = (replace(each, test="") for each in (named("a"), named("a", 1.9)))
    assert compared([old], [new], {"test_peers.py": [(old, 1.2)]}) == 1


def test_tests_that_are_measured_are_named_as_the_folder_has_them(pytestconfig):
    assert (HERE / "bench" / ROW.test.partition("::")[0]).exists()
    assert Path(pytestconfig.rootpath) == HERE
