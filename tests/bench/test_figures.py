"""What a run finds, as data: medians, ratios round by round, slopes."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from functools import partial

import pytest

from bench.contest import Contender, held
from bench.figures import Spread, chapters, from_json, ratio, to_json
from bench.loops import contender
from bench.report.tables import target
from bench.slopes import exponent, too_steep
from bench.turns import Effort
from tests.bench import runs


def test_a_spread_is_the_median_between_quartiles():
    assert Spread.of([5.0, 1.0, 2.0, 4.0, 3.0]) == Spread(3.0, 2.0, 4.0)
    assert Spread.of([7.0]) == Spread(7.0, 7.0, 7.0)


def test_a_target_is_missed_from_the_third_digit_on():
    assert [runs.row(median=each, at_most=1.0).met for each in (0.9, 1.004, 1.006)] == [True, True, False]
    assert [runs.row(median=each, at_most=120.0).met for each in (120.4, 120.6)] == [True, False]


def test_ratios_are_of_single_rounds():
    """A moment that slows both down threefold does not show."""
    assert ratio([10.0, 30.0, 10.0], [5.0, 15.0, 5.0]) == Spread(2.0, 2.0, 2.0)


def test_ratios_are_given_net_of_the_loops_too():
    effort = Effort(5, 0.002, quick=True)
    body = "".join(["sum(m)\n"] * 3)
    contenders = [contender(effort, who, "ours", "", body[: 7 * times], [range(30)] * 7) for times, who in ((3, "three"), (1, "one"))]
    outcome = held(effort, contenders)
    measured = outcome.ratio("three", "one")
    assert outcome.idle_ns.keys() == {"one", "three"}
    assert measured.net > measured.median
    assert contenders[0].timed.different == 7
    assert held(effort, [Contender(who, "ours", "", lambda: 2.0) for who in "ab"]).ratio("a", "b") == Spread(1.0, 1.0, 1.0)


def test_rows_say_how_many_messages_there_were():
    shown = [target(replace(runs.row(), messages=each))[-1] for each in (None, 1, 1000)]
    assert shown == ["25 ns", "25 ns; one message, repeated", "25 ns; 1,000 messages in turn"]
    measured = replace(runs.row(), measured=Spread(1.5, 1.4, 1.6, 1.75))
    assert target(measured)[1] == "1.5 (1.4 to 1.6), 1.75 net x len()"


def test_reports_survive_json():
    report = runs.report()
    assert from_json(json.loads(json.dumps(to_json(report)))) == report


def test_chapters_gather_what_was_measured_apart():
    first, *_ = runs.report().comparisons
    other = type(first)("Limits", "a call", first.figures)
    assert chapters([first, other, first]) == {"Decoding": [first, first], "Limits": [other]}


@pytest.mark.parametrize("power", [0.0, 0.5, 1.0, 2.0])
def test_the_exponent_is_the_slope_in_logarithms(power):
    assert exponent(runs.curve(power).series[0]) == pytest.approx(power)


def test_only_what_outgrows_its_job_is_too_steep():
    assert too_steep(runs.curve(2.0)) == ("decode",)
    assert too_steep(runs.curve(1.1)) == ()
    assert too_steep(runs.curve(1.1, may_grow=0.0)) == ("decode",)
    assert too_steep(runs.curve(2.0, role="limit")) == ()


def test_a_limit_that_grows_as_much_explains():
    ours, limit = runs.curve(1.5).series, runs.curve(1.4, role="limit").series
    both = type(runs.curve(1.0))("size", "bytes", "ns", (*ours, *limit))
    assert too_steep(both) == ()


def test_contenders_are_measured_in_turns():
    calls = []
    outcome = held(Effort(3, 0.001, quick=True), [Contender(who, "ours", "", lambda who=who: calls.append(who) or 1.0) for who in "ab"])
    assert calls == list("ab") * 4
    assert outcome.rounds_ns == {"a": (1.0,) * 3, "b": (1.0,) * 3}


def test_a_call_is_timed_without_what_waits():
    """The clock is the thread's: it stands while the thread sleeps."""
    asleep = Effort(3, 0.001, quick=True).call(time.sleep, 0.02, count=2)
    assert 0 < asleep() < 10e6


def test_a_first_call_that_compiles_does_not_shorten_the_rounds():
    """Peers write their functions at the first call: were it counted, a round would be one call, and that a cold one."""
    made = []

    def decode():
        if not made:
            made.append(sum(range(3_000_000)))

    effort = Effort(3, 0.004, quick=True)
    assert effort.call(decode).count > 1000


def test_a_job_is_in_another_place_each_round():
    """A place in which copies are slow decides nothing."""
    costs = iter([1.0, 10.0, 2.0, 3.0, 4.0])
    placed = Effort(10, 0.001, quick=True).placed(lambda cost=costs: partial(float, next(cost)))
    taken = Effort(10, 0.001, quick=True).in_turns({"a": placed})["a"]
    assert sorted(taken) == [1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 10.0, 10.0]
    assert Spread.of(taken).median == 3.0


def test_a_call_counts_messages():
    effort = Effort(3, 0.001, quick=True)
    one, thousand = effort.call(sum, range(10_000), count=20), effort.call(sum, range(10_000), count=20, messages=1000)
    assert 100 < min(one() for _ in range(5)) / min(thousand() for _ in range(5)) < 10_000
