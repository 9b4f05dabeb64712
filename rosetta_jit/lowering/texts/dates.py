"""Points in time as text (ISO 8601, RFC 3339): `2026-11-21T10:08:42.123456789Z`, in the Gregorian calendar of the years 0 to 9999.

Written is UTC, with no decimals, or 3, 6 or 9, as few as tell the nanoseconds. Read is any offset from UTC; it must be there.
The calendar's arithmetic counts years from March, so that the leap day is the last (E. G. Richards, Mapping Time, chapter 25).
"""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Binary, Compare, Convert, Expr, If, Local, Select, Unary
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.texts.views import (
    TRUE,
    View,
    between,
    byte_at,
    has_room,
    is_between,
    is_one_of,
    kept,
    parameters,
    put,
    room,
    scanning,
)
from rosetta_jit.lowering.writer import MESSAGE, Contract, Writer, block
from rosetta_jit.startup.dataclass import dataclass

SECOND = 10**9
"""In nanoseconds."""

MINUTE, HOUR, DAY = 60, 3600, 86400
LEAST_SECONDS, MOST_SECONDS = -62167219200, 253402300799
"""The first second of the year 0 and the last of 9999, from 1970 on."""

CYCLE_DAYS, CYCLE_YEARS = 146097, 400
"""After so many days and years the calendar is the same."""

MARCH = 60
"""Days of the year 0 before its March: it is a leap year."""

DATE_SIZE, ROOM = 19, 32
"""Bytes up to the seconds, and at most."""

GOOD, NO_DATE, TOO_FINE = 0, 1, 2


@dataclass(frozen=True, slots=True)
class ReadDate:
    """Whole seconds since 1970 and the nanoseconds behind them; whether there was no date, or decimals beyond the nanoseconds."""

    seconds: Expr
    nanoseconds: Expr
    is_none: Expr
    is_too_fine: Expr


# --- writing -------------------------------------------------------------------------------------------------------------


def split(writer: Writer, nanoseconds: Expr) -> tuple[Local, Local]:
    """Nanoseconds as whole seconds, rounded down, and those behind them."""
    value = writer.let("time", nanoseconds)
    over = writer.let("over", Binary("rem", value, index(SECOND)))
    is_below = Compare("lt", over, index(0))
    seconds = Binary("sub", Binary("div", value, index(SECOND)), Select(is_below, index(1), index(0)))
    return writer.let("seconds", seconds), writer.let("nanoseconds", Select(is_below, add(over, SECOND), over))


def written_date(writer: Writer, seconds: Expr, nanoseconds: Expr) -> View:
    """A point in time, within the years that have four digits, and less than a second of nanoseconds."""
    start = room(writer, index(ROOM))
    (after,) = writer.call("write_date", _write_date, (seconds, nanoseconds, start), MESSAGE)
    return kept(writer, start, start, after, valid=True)


def _write_date(writer: Writer) -> Contract:
    seconds, nanoseconds, target = (writer.parameter(name, "i64") for name in ("seconds", "nanoseconds", "target"))
    since = writer.let("since", add(seconds, -LEAST_SECONDS))
    day, clock = writer.let("day", Binary("div", since, index(DAY))), writer.let("clock", Binary("rem", since, index(DAY)))
    at = 0
    for number, width, behind in (*_calendar(writer, day), *_clock(clock)):
        for place in range(width):
            figure = Binary("rem", Binary("div", number, index(10 ** (width - 1 - place))), index(10))
            put(writer, add(target, at + place), Convert("u8", add(figure, ord("0"))))
        put(writer, add(target, at + width), ord(behind))
        at += width + 1
    for place in range(9):
        figure = Binary("rem", Binary("div", nanoseconds, index(10 ** (8 - place))), index(10))
        put(writer, add(target, DATE_SIZE + 1 + place), Convert("u8", add(figure, ord("0"))))
    end = writer.let("end", Binary("add", target, _length(nanoseconds)))
    put(writer, end, ord("Z"))
    years = Compare("ge", seconds, index(LEAST_SECONDS)), Compare("le", seconds, index(MOST_SECONDS))
    decimals = Compare("ge", nanoseconds, index(0)), Compare("lt", nanoseconds, index(SECOND))
    after = writer.let("after", add(end, 1))
    ends = Compare("ge", after, target), Compare("le", after, add(target, ROOM))
    return Contract((seconds, nanoseconds, target), (after,), (*has_room(writer, target, index(ROOM)), *years, *decimals), ends)


def _calendar(writer: Writer, day: Local) -> tuple[tuple[Expr, int, str], ...]:
    """Year, month and day of a day since the begin of the year 0, with their digits and what follows them."""
    march = writer.let("march", add(day, CYCLE_DAYS - MARCH))
    cycle, of_cycle = Binary("div", march, index(CYCLE_DAYS)), writer.let("of_cycle", Binary("rem", march, index(CYCLE_DAYS)))
    without_leaps = _quotients(of_cycle, (1, 1), (-1, 1460), (1, 36524), (-1, 146096))
    years = writer.let("years", Binary("div", without_leaps, index(365)))
    of_year = writer.let("of_year", Binary("sub", of_cycle, _days_of_years(years)))
    month = writer.let("month", Binary("div", add(mul(of_year, 5), 2), index(153)))
    is_next_year = Compare("ge", month, index(10))
    year = Binary("add", Binary("add", mul(cycle, CYCLE_YEARS), years), Select(is_next_year, index(1), index(0)))
    day_of_month = add(Binary("sub", of_year, _month_start(month)), 1)
    return (add(year, -CYCLE_YEARS), 4, "-"), (Select(is_next_year, add(month, -9), add(month, 3)), 2, "-"), (day_of_month, 2, "T")


def _clock(clock: Local) -> tuple[tuple[Expr, int, str], ...]:
    minutes = Binary("rem", Binary("div", clock, index(MINUTE)), index(60))
    return (Binary("div", clock, index(HOUR)), 2, ":"), (minutes, 2, ":"), (Binary("rem", clock, index(MINUTE)), 2, ".")


def _quotients(number: Expr, *parts: tuple[int, int]) -> Expr:
    """The sum of a number's quotients, each with its sign."""
    total: Expr = index(0)
    for sign, divisor in parts:
        quotient = number if divisor == 1 else Binary("div", number, index(divisor))
        total = Binary("add" if sign > 0 else "sub", total, quotient)
    return total


def _days_of_years(years: Expr) -> Expr:
    """The days of so many years of a cycle that begins with a March of a year that 400 divides."""
    return Binary("add", mul(years, 365), _quotients(years, (1, 4), (-1, 100)))


def _month_start(month: Expr) -> Expr:
    """The days before a month, counted from March as 0."""
    return Binary("div", add(mul(month, 153), 2), index(5))


def _length(nanoseconds: Expr) -> Expr:
    """Bytes before the `Z`."""
    micro = Compare("eq", Binary("rem", nanoseconds, index(10**3)), index(0))
    milli = Compare("eq", Binary("rem", nanoseconds, index(10**6)), index(0))
    size = Select(milli, index(DATE_SIZE + 4), Select(micro, index(DATE_SIZE + 7), index(DATE_SIZE + 10)))
    return Select(Compare("eq", nanoseconds, index(0)), index(DATE_SIZE), size)


# --- reading -------------------------------------------------------------------------------------------------------------


def read_date(writer: Writer, view: View) -> ReadDate:
    """A point in time from text; seconds from 0 to 59, hours from 0 to 23."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        seconds, nanoseconds, state = (inner.var(name, index(0)) for name in ("seconds", "nanoseconds", "state"))
        inner.assign(state, index(NO_DATE))
        with inner.nested() as long_enough:
            day, good = _date(inner, view.lane, first)
            rest, fine = _fraction(inner, view.lane, add(first, DATE_SIZE), after, nanoseconds)
            offset, known_offset = _offset(inner, view.lane, rest, after)
            inner.assign(seconds, Binary("sub", day, offset))
            complete = Binary("and", good, Compare("eq", known_offset, index(1)))
            inner.assign(state, Select(complete, fine, index(NO_DATE)))
        inner.emit(If(Compare("gt", Binary("sub", after, first), index(DATE_SIZE)), block(long_enough)))
        limits = (LEAST_SECONDS - DAY, MOST_SECONDS + DAY), (0, SECOND)
        total, small = (
            inner.let("found", between(each, index(low), index(high)))
            for each, (low, high) in zip((seconds, nanoseconds), limits, strict=True)
        )
        promised = [
            Compare(op, each, index(end))
            for each, ends in zip((total, small), limits, strict=True)
            for op, end in zip(("ge", "le"), ends, strict=True)
        ]
        return Contract((first, after), (total, small, state), known, tuple(promised))

    seconds, nanoseconds, state = writer.call(f"read_date_{view.memory}", make, (view.first, view.after), MESSAGE)
    return ReadDate(seconds, nanoseconds, Compare("eq", state, index(NO_DATE)), Compare("eq", state, index(TOO_FINE)))


def _date(writer: Writer, lane: int | None, first: Local) -> tuple[Expr, Expr]:
    """The seconds from 1970 that `2026-11-21T10:08:42` says, and whether it is such a text."""
    text = [writer.let("byte", byte_at(lane, add(first, place))) for place in range(DATE_SIZE)]
    starts = (0, 4), (5, 2), (8, 2), (11, 2), (14, 2), (17, 2)
    year, month, day, hour, minute, second = (writer.let("figures", _figures(text[at : at + width])) for at, width in starts)
    good: Expr = TRUE
    for place, marks in ((4, b"-"), (7, b"-"), (10, b"Tt "), (13, b":"), (16, b":")):
        good = Binary("and", good, is_one_of(text[place], marks))
    for at, width in starts:
        for byte in text[at : at + width]:
            good = Binary("and", good, is_between(byte, ord("0"), ord("9")))
    limits = (month, 1, index(12)), (day, 1, _days_of(year, month)), (hour, 0, index(23)), (minute, 0, index(59)), (second, 0, index(59))
    for number, low, high in limits:
        good = Binary("and", good, Binary("and", Compare("ge", number, index(low)), Compare("le", number, high)))
    clock = Binary("add", Binary("add", mul(hour, HOUR), mul(minute, MINUTE)), second)
    days = writer.let("days", _days(writer, year, month, day))
    return Binary("add", add(mul(days, DAY), LEAST_SECONDS), clock), writer.let("good", good)


def _figures(text: list[Local]) -> Expr:
    number: Expr = index(0)
    for byte in text:
        number = Binary("add", mul(number, 10), Binary("and", Convert("i64", byte), index(15)))
    return number


def _days_of(year: Expr, month: Expr) -> Expr:
    """The days of a month."""
    four, hundred, cycle = (Compare("eq", Binary("rem", year, index(each)), index(0)) for each in (4, 100, CYCLE_YEARS))
    leap = Binary("or", Binary("and", four, Unary("not", hundred)), cycle)
    february = Select(leap, index(29), index(28))
    usual = add(Binary("and", Binary("xor", month, Binary("shr", month, index(3))), index(1)), 30)
    return Select(Compare("eq", month, index(2)), february, usual)


def _days(writer: Writer, year: Expr, month: Expr, day: Expr) -> Expr:
    """The days since the begin of the year 0."""
    is_early = Compare("lt", month, index(3))
    march = writer.let("march", Binary("sub", add(year, CYCLE_YEARS), Select(is_early, index(1), index(0))))
    cycle, of_cycle = Binary("div", march, index(CYCLE_YEARS)), writer.let("of_cycle", Binary("rem", march, index(CYCLE_YEARS)))
    from_march = writer.let("from_march", Binary("max", Select(is_early, add(month, 9), add(month, -3)), index(0)))
    days = Binary("add", _days_of_years(of_cycle), Binary("add", _month_start(from_march), day))
    return add(Binary("add", mul(cycle, CYCLE_DAYS), days), MARCH - CYCLE_DAYS - 1)


def _fraction(writer: Writer, lane: int | None, first: Expr, after: Local, nanoseconds: Local) -> tuple[Local, Local]:
    """Read decimals, if there are any; gives where they end, and whether they are too fine, or none behind a point."""
    point = writer.let("point", first)
    end, fine, unit = writer.var("end_of_decimals", point), writer.var("fine", index(GOOD)), writer.var("unit", index(SECOND))
    with writer.nested() as some:
        writer.assign(end, after)

        def keeps(_at: Expr) -> tuple[Expr, ...]:
            both = ((unit, SECOND), (nanoseconds, SECOND))
            return tuple(each for number, most in both for each in (Compare("ge", number, index(0)), Compare("le", number, index(most))))

        with scanning(writer, lane, add(point, 1), after, keeps) as scan:
            with writer.nested() as digit:
                value = writer.let("figure", Binary("and", Convert("i64", scan.byte), index(15)))
                writer.assign(unit, Binary("div", unit, index(10)))
                writer.assign(nanoseconds, Binary("min", Binary("add", nanoseconds, Binary("mul", value, unit)), index(SECOND)))
                is_lost = Binary("and", Compare("eq", unit, index(0)), Compare("ne", value, index(0)))
                writer.assign(fine, Select(is_lost, index(TOO_FINE), fine))
            with writer.nested() as other:
                writer.assign(end, scan.at)
                writer.assign(scan.done, TRUE)
            writer.emit(If(is_between(scan.byte, ord("0"), ord("9")), block(digit), block(other)))
        writer.assign(fine, Select(Compare("eq", unit, index(SECOND)), index(NO_DATE), fine))
    writer.emit(If(is_one_of(byte_at(lane, point), b".,"), block(some)))
    return writer.let("rest", between(end, point, after)), fine


def _offset(writer: Writer, lane: int | None, first: Local, after: Local) -> tuple[Local, Local]:
    """The seconds that a text is ahead of UTC: `Z`, `+01:00`, `+0100`, `+01`; and 1 where it is one of these."""
    offset, known = writer.var("offset", index(0)), writer.var("known", index(0))
    size = writer.let("size", Binary("sub", after, first))
    with writer.nested() as utc:
        writer.assign(known, Select(is_one_of(byte_at(lane, first), b"Zz"), index(1), index(0)))
    ways = (If(Compare("eq", size, index(1)), block(utc)),)
    for length, colon in ((3, None), (5, None), (6, 3)):
        with writer.nested() as some:
            text = [writer.let("byte", byte_at(lane, add(first, place))) for place in range(length)]
            _read_offset(writer, text, colon, offset, known)
        ways = (If(Compare("eq", size, index(length)), block(some), ways),)
    writer.emit(*ways)
    return offset, known


def _read_offset(writer: Writer, text: list[Local], colon: int | None, offset: Local, known: Local) -> None:
    figures = [byte for place, byte in enumerate(text) if place not in (0, colon)]
    good = is_one_of(text[0], b"+-") if colon is None else Binary("and", is_one_of(text[0], b"+-"), is_one_of(text[colon], b":"))
    for byte in figures:
        good = Binary("and", good, is_between(byte, ord("0"), ord("9")))
    hours = writer.let("hours", _figures(figures[:2]))
    minutes = writer.let("minutes", _figures(figures[2:]))
    in_day = Binary("and", Compare("le", hours, index(23)), Compare("le", minutes, index(59)))
    ahead = writer.let("ahead", Binary("add", mul(hours, HOUR), mul(minutes, MINUTE)))
    writer.assign(offset, Select(is_one_of(text[0], b"-"), Unary("neg", ahead), ahead))
    writer.assign(known, Select(Binary("and", good, in_day), index(1), index(0)))
