"""Runs of the benchmarks that were never made: for tests of what is done with them."""

from __future__ import annotations

from bench.figures import Comparison, Curve, Figure, Report, Row, Series, Spread, to_json

HOSTILE = '<script>alert("|")</script>'


def row(what="decode", median=1.5, *, at_most=2.0, width=0.1, against=""):
    return Row(what, Spread(median, median - width, median + width), at_most, "x len()", "25 ns", against)


def curve(exponent, *, role="ours", may_grow=1.0, factor=3.0):
    points = tuple((float(x), Spread.of([factor * x**exponent])) for x in (1, 10, 100, 1000, 10_000))
    return Curve("size", "bytes", "ns", (Series("decode", role, points),), may_grow=may_grow)


def report(*rows):
    figures = (
        Figure("rosetta_jit", "ours", "a holder, used again", (20.0, 30.0, 40.0)),
        Figure(HOSTILE, "peer", "an object, anew", (200.0, 600.0, 400.0)),
        Figure("len()", "limit", "a number", (10.0, 10.0, 10.0)),
    )
    shares = tuple(
        Series(stage, "ours", ((1.0, Spread.of([ms])), (10.0, Spread.of([2 * ms])))) for stage, ms in (("parse", 1.0), ("LLVM", 3.0))
    )
    stacked = Curve("cold compile", "fields", "ms", shares, parts=True)
    return Report(rows or (row(),), (Comparison("Decoding", HOSTILE, figures),), (curve(2.0), curve(1.0), stacked))


def run(*rows):
    """As pytest-benchmark's JSON carries it."""
    return {
        "machine_info": {
            "system": "Linux",
            "release": "6",
            "python_implementation": "CPython",
            "python_version": "3.11",
            "cpu": {"count": 2},
        },
        "commit_info": {"id": "abc", "dirty": True},
        "datetime": "2026-01-01",
        "rosetta_jit": {**to_json(report(*rows)), "quick": True, "versions": {"numpy": "2"}},
    }
