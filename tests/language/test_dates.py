"""Dates, against Python's datetime and exact integers."""

from __future__ import annotations

import random
from datetime import UTC, datetime, timedelta, timezone

import pytest

import rosetta_jit as rj
from tests.language.texts import BACKENDS, decoder

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
FIRST, LAST = -62135596800, 253402300799
"""The seconds of Python's first and last year; ours has a year 0 before."""


def shown(seconds, nanoseconds):
    text = (EPOCH + timedelta(seconds=seconds)).strftime("%Y-%m-%dT%H:%M:%S").rjust(19, "0")
    digits = f"{nanoseconds:09}"
    while digits.endswith("000"):
        digits = digits[:-3]
    return f"{text}.{digits}Z" if digits else f"{text}Z"


def moments():
    rng = random.Random(3)
    edges = [(0, 0), (-1, 999_999_999), (FIRST, 0), (LAST, 999_000_000), (951782400, 1000), (1709164800, 0), (-2203891200, 5)]
    return edges + [(rng.randint(FIRST, LAST), rng.choice([0, 10**6 * rng.randrange(1000), rng.randrange(10**9)])) for _ in range(100)]


@pytest.mark.parametrize("backend", BACKENDS)
def test_dates_are_written_and_read(backend):
    write = decoder({"s": "iso8601(.i, .j)"}, backend)
    read = decoder({"n": "seconds(.s)", "x": "float64(fraction(.s))"}, backend)
    for seconds, nanoseconds in moments():
        text = shown(seconds, nanoseconds)
        assert write(i=seconds, j=nanoseconds)["s"] == text
        found = read(s=text)
        assert (found["n"], found["x"]) == (seconds, nanoseconds)


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_year_0(backend):
    write, read = decoder({"s": "iso8601(.i, .j)"}, backend), decoder({"n": "seconds(.s)"}, backend)
    for seconds, text in [
        (-62167219200, "0000-01-01T00:00:00Z"),
        (-62162121600, "0000-02-29T00:00:00Z"),
        (FIRST - 1, "0000-12-31T23:59:59Z"),
    ]:
        assert write(i=seconds, j=0)["s"] == text
        assert read(s=text)["n"] == seconds


@pytest.mark.parametrize("backend", BACKENDS)
def test_nanoseconds(backend):
    write, read = decoder({"s": "iso8601(.i)"}, backend), decoder({"n": "nanoseconds(.s)"}, backend)
    for time in (0, -1, 1795255722123456789, 2**63 - 1, -(10**18) - 7, -9223372036 * 10**9):
        text = shown(*divmod(time, 10**9))
        assert write(i=time)["s"] == text
        assert read(s=text)["n"] == time
    for text in ("2262-04-11T23:47:16.854775808Z", "1600-01-01T00:00:00Z"):
        with pytest.raises(rj.DecodeError) as error:
            read(s=text)
        assert error.value.kind == "range"


@pytest.mark.parametrize("backend", BACKENDS)
def test_offsets_and_forms(backend):
    read = decoder({"n": "nanoseconds(.s)"}, backend)
    for hours, minutes, zone in [(1, 30, "+01:30"), (-5, 0, "-0500"), (14, 0, "+14"), (0, 0, "-00:00"), (-23, -59, "-23:59"), (0, 0, "z")]:
        moment = datetime(2026, 11, 21, 10, 8, 42, 500000, tzinfo=timezone(timedelta(hours=hours, minutes=minutes)))
        expected = int((moment - EPOCH) / timedelta(microseconds=1)) * 1000
        for text in ("2026-11-21T10:08:42.5", "2026-11-21t10:08:42,50", "2026-11-21 10:08:42.500000000000"):
            assert read(s=text + zone)["n"] == expected


WRONG = [
    "",
    "2026-11-21",
    "2026-11-21T10:08:42",
    "2026-11-21T10:08Z",
    "2026-11-21T10:08:42.Z",
    "2026-11-21T10:08:42ZZ",
    "2026-13-01T00:00:00Z",
]
WRONG += ["2026-00-01T00:00:00Z", "2026-01-00T00:00:00Z", "2026-04-31T00:00:00Z", "2026-02-29T00:00:00Z", "2100-02-29T00:00:00Z"]
WRONG += ["2026-11-21T24:00:00Z", "2026-11-21T10:60:00Z", "2026-11-21T10:08:60Z", "2026-11-21T10:08:42+24:00", "2026-11-21T10:08:42+01:60"]
WRONG += ["2026-11-21T10:08:42+1:00", "2026-11-21T10:08:42+0a", "+026-11-21T10:08:42Z", "20261121T100842Z", "2026-11-21T10:08:4\uff12Z"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_texts_that_are_no_date(backend):
    read = decoder({"n": "seconds(.s)"}, backend)
    for text in WRONG:
        with pytest.raises(rj.DecodeError, match="no date") as error:
            read(s=text)
        assert (error.value.kind, error.value.path) == ("text", ".n")
    with pytest.raises(rj.DecodeError, match="finer than nanoseconds") as error:
        read(s="2026-11-21T10:08:42.0000000001Z")
    assert error.value.kind == "range"


@pytest.mark.parametrize("backend", BACKENDS)
def test_times_that_have_no_date(backend):
    write = decoder({"s": "iso8601(.i, .j)"}, backend)
    for seconds, nanoseconds in ((LAST + 1, 0), (-62167219201, 0), (0, 10**9), (0, -1), (2**63 - 1, 0), (-(2**63), 0)):
        with pytest.raises(rj.DecodeError) as error:
            write(i=seconds, j=nanoseconds)
        assert error.value.kind == "range"


OF_TIMES = {
    ".i * 1000000 + floor_divide(.j, 1000)": lambda s, ns: s * 10**6 + ns // 1000,
    "floor_divide(.i, 1000000) * 1000000000 + modulo(.i, 1000000) * 1000": lambda us, _: us * 1000,
    "int64(floor(.x)) * 1000000000 + int64((.x - floor(.x)) * 1e9, round)": None,
}


@pytest.mark.parametrize("backend", BACKENDS)
def test_seconds_micro_and_nanoseconds(backend):
    """Pairs, µs and floating seconds: integers with floors, so that times before 1970 come out right, and a carry is no special case."""
    for expression in list(OF_TIMES)[:2]:
        run = decoder({"n": expression}, backend)
        for seconds in (0, 1795255722, -1, -1795255722123, 8 * 10**12):
            for nanoseconds in (0, 999_999_999):
                assert run(i=seconds, j=nanoseconds)["n"] == OF_TIMES[expression](seconds, nanoseconds)
    with pytest.raises(rj.DecodeError, match="64 bits") as error:
        decoder({"n": ".i * 1000000000 + .j"}, backend)(i=9223372037, j=0)
    assert error.value.kind == "range"
    run = decoder({"n": list(OF_TIMES)[2]}, backend)
    for x in (0.0, -0.25, 1795255722.125, 0.9999999999, -1e-10, 1e9 + 0.1):
        whole = int(x // 1)
        assert run(x=x)["n"] == whole * 10**9 + round((x - whole) * 1e9)
