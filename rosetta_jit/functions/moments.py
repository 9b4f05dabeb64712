"""Points in time: seconds since 1970 and the nanoseconds behind them, put together and taken apart.

A moment is a text (`lowering.texts.dates`), a float64 of seconds, an int64 of nanoseconds, or whole seconds and nanoseconds from 0 to below
10⁹.
"""

from __future__ import annotations

from functools import partial

from rosetta_jit.functions.forms import loses, row, undone_by
from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Expr, Local, Select, Unary
from rosetta_jit.kernel.terms import add, index, type_of
from rosetta_jit.language import typed
from rosetta_jit.language.affine_steps import Error, LostError, Value
from rosetta_jit.language.conversions import FLOAT64, bare, is_textual
from rosetta_jit.language.function import SEVERAL, ByType, Function, Texts, Whole
from rosetta_jit.language.functions.texts import TEXT, type_texts
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import INT64
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.dates import LEAST_SECONDS, MOST_SECONDS, SECOND, read_date, split, written_date
from rosetta_jit.lowering.texts.values import expect, placed_of
from rosetta_jit.lowering.texts.views import View
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Float, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

BEYOND = float(1 << 63)
"""The first float that is no int64."""

NANOSECOND = 4.6e6
"""Seconds whose float64, rounded, is off by at most half a nanosecond and what rounding that has added: 0.5000003e-9 · 2^53 and more."""

DATE = "a date is written in one way, in UTC, however it was spelt"
FLOATING = "it is rounded to a float64, which tells moments of today to about 240 ns"


# --- types ---------------------------------------------------------------------------------------------------------------

OF_NUMBERS = Texts(("integer", "integer"), INT64)
"""`nanoseconds` of seconds and the nanoseconds behind them."""

OF_MOMENT = Texts(("moment",), INT64)


def _type_nanoseconds(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    return type_texts(call, arguments, scope, OF_NUMBERS if len(arguments) == 2 else OF_MOMENT)


# --- kernels -------------------------------------------------------------------------------------------------------------


def _lower_iso8601(call: typed.Call, values: Evaluation) -> View:
    seconds, nanoseconds = _of_numbers(call, values)
    years = Binary("and", Compare("ge", seconds, index(LEAST_SECONDS)), Compare("le", seconds, index(MOST_SECONDS)))
    expect(values, years, "range", "a time before the year 0 or after 9999")
    return written_date(values.writer, seconds, nanoseconds)


def _lower_seconds(call: typed.Call, values: Evaluation) -> Expr:
    return _moment(call, values)[0]


def _lower_fraction(call: typed.Call, values: Evaluation) -> Expr:
    return _moment(call, values)[1]


def _lower_timestamp(call: typed.Call, values: Evaluation) -> Expr:
    seconds, nanoseconds = _moment(call, values)
    return Binary("add", Convert("f64", seconds), Binary("div", Convert("f64", nanoseconds), Const("f64", float(SECOND))))


def _lower_nanoseconds(call: typed.Call, values: Evaluation) -> Expr:
    """All int64 of nanoseconds can be reached: before 1970 the nanoseconds are counted down from the next second."""
    seconds, nanoseconds = _moment(call, values)
    writer = values.writer
    whole, behind = writer.let("whole", seconds), writer.let("behind", nanoseconds)
    is_before = Compare("lt", whole, index(0))
    next_ = writer.let("next", Select(is_before, index(1), index(0)))
    product = writer.checked(
        "mul", writer.checked("add", whole, next_, values.where, line=values.line), index(SECOND), values.where, line=values.line
    )
    rest = writer.let("rest", Select(is_before, add(behind, -SECOND), behind))
    return writer.checked("add", product, rest, values.where, line=values.line)


def _moment(call: typed.Call, values: Evaluation) -> tuple[Expr, Expr]:
    """The seconds and nanoseconds of what a function is given."""
    is_text = len(call.arguments) == 1 and is_textual(call.arguments[0].type)
    return _of_text(placed_of(call.arguments[0], values), values) if is_text else _of_numbers(call, values)


def _of_numbers(call: typed.Call, values: Evaluation) -> tuple[Expr, Expr]:
    first, *others = (values.of(each) for each in call.arguments)
    if others:
        return _of_pair(first, others[0], values)
    return _of_float(values.writer.let("time", first), values) if type_of(first) == "f64" else split(values.writer, first)


def _of_pair(seconds: Expr, nanoseconds: Expr, values: Evaluation) -> tuple[Expr, Expr]:
    whole, behind = values.writer.let("time", seconds), values.writer.let("time", nanoseconds)
    within = Binary("and", Compare("ge", behind, index(0)), Compare("lt", behind, index(SECOND)))
    expect(values, within, "range", "the nanoseconds are not less than a second")
    return whole, behind


def _of_text(view: View, values: Evaluation) -> tuple[Expr, Expr]:
    read = read_date(values.writer, view)
    expect(values, Unary("not", read.is_none), "text", "the text is no date with a time and its offset")
    expect(values, Unary("not", read.is_too_fine), "range", "the date is finer than nanoseconds")
    return read.seconds, read.nanoseconds


def _of_float(time: Local, values: Evaluation) -> tuple[Expr, Expr]:
    """Rounded to nanoseconds, which may make a second full. What is behind the point of a float is a float, exactly."""
    writer = values.writer
    below = writer.let("below", Unary("floor", time))
    rounded = writer.let("rounded", Unary("rint", Binary("mul", Binary("sub", time, below), Const("f64", float(SECOND)))))
    is_full = Compare("ge", rounded, Const("f64", float(SECOND)))
    whole = writer.let("whole", Select(is_full, Binary("add", below, Const("f64", 1.0)), below))
    for within in (Compare("ge", whole, Const("f64", -BEYOND)), Compare("lt", whole, Const("f64", BEYOND))):
        expect(values, within, "range", "the seconds do not fit int64")
    behind = writer.let("behind", Convert("i64", Select(is_full, Const("f64", 0.0), rounded)))
    for within in (Compare("ge", behind, index(0)), Compare("lt", behind, index(SECOND))):
        expect(values, within, "range", "the seconds do not fit int64")  # true anyway; said for the proof
    return writer.let("seconds", Convert("i64", whole)), behind


# --- the other direction -------------------------------------------------------------------------------------------------


def _nanoseconds_of(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr] | None:
    return (call.arguments[0], model.Call("nanoseconds", (value,), call.span)) if len(call.arguments) == 1 else None


def _moment_of(call: model.Call, value: model.Expr, type_: Type | None) -> tuple[model.Expr, model.Expr] | None:
    return (call.arguments[0], _moment_as(type_, (value,), call.span)) if len(call.arguments) == 1 else None


def _moment_of_seconds(call: model.Call, value: model.Expr, type_: Type | None) -> tuple[model.Expr, model.Expr]:
    return call.arguments[0], _moment_as(type_, (value, model.Literal(0, call.span)), call.span)


def _moment_as(type_: Type | None, arguments: tuple[model.Expr, ...], span: Span | None) -> model.Expr:
    """A moment as a float, or as a text."""
    return model.Call("timestamp" if isinstance(type_, Float) else "iso8601", arguments, span)


def _split(call: model.Call, value: model.Expr) -> tuple[tuple[model.Expr, model.Expr], tuple[model.Expr, model.Expr]]:
    seconds, behind = call.arguments
    return (seconds, model.Call("seconds", (value,), call.span)), (behind, model.Call("fraction", (value,), call.span))


def _split_number(call: model.Call, value: model.Expr) -> tuple[tuple[model.Expr, model.Expr], tuple[model.Expr, model.Expr]]:
    seconds, behind = call.arguments
    second = model.Literal(SECOND, call.span)
    whole, rest = (model.Call(function, (value, second), call.span) for function in ("floor_divide", "modulo"))
    return (seconds, whole), (behind, rest)


def _joined(call: model.Call, high: model.Expr, low: model.Expr, type_: Type | None) -> model.Expr:
    return _moment_as(type_, (high, low), call.span)


def _below(call: model.Call) -> int | None:
    return 0 if len(call.arguments) == 1 else None


# --- laws ----------------------------------------------------------------------------------------------------------------


def _is_of_float(call: typed.Call) -> bool:
    return isinstance(call.arguments[0].type, Float)


def _dated_again(opening: typed.Call, _step: typed.Call, before: Value) -> Value | None:
    return before if len(opening.arguments) == 1 else None


def _whole_again(opening: typed.Call, _step: typed.Call, before: Value) -> Value | None:
    return before if isinstance(opening.arguments[-1], typed.Const) else None


def _timed_again(opening: typed.Call, _step: typed.Call, before: Value) -> Value | None:
    """A float64 of seconds that is rounded to nanoseconds and put together again: off by at most half of one, and one rounding more."""
    floor = (before.offset + NANOSECOND) / before.size
    return replace(before, errors=(*before.errors, Error(2.0**-53, floor, is_tiny=False))) if _is_of_float(opening) else None


def _spelt_again(opening: typed.Call, _step: typed.Call, _before: Value) -> Value | None:
    if _is_of_float(opening):
        return None
    raise LostError(DATE if opening.function == "nanoseconds" else "it becomes a whole second, in UTC")


def _part_again(number: int, call: typed.Call) -> typed.Expr | None:
    """The seconds, or the nanoseconds behind them, of a date that is spelt from both."""
    match call.arguments:
        case (typed.Call("iso8601", (_, _) as both),):
            return both[number]
        case _:
            return None


def _whole_moment(call: typed.Call) -> typed.Expr | None:
    """What both parts of one moment make: where they do not fit an int64 of nanoseconds, this is not computed."""
    match tuple(map(bare, call.arguments)):
        case typed.Call("seconds", (moment,)), typed.Call("fraction", (other,)) if moment == other:
            return replace(call, arguments=(typed.Call("nanoseconds", (moment,), INT64),))
        case _:
            return None


of_moments = partial(Function, operation="date manipulation", kept=False)

AS_TEXT = row(
    "`iso8601(ns)`, `iso8601(secs, nsecs)`",
    "`2026-11-21T10:08:42.500Z`: UTC, with 0, 3, 6 or 9 decimals, as few as tell the nanoseconds; years 0 to 9999; "
    "`nsecs` from 0 to 999999999",
    "`range`",
)
OF_TEXT = row(
    "`seconds(s)`, `fraction(s)`",
    "of such a text with any offset (`Z`, `+01:30`, `+0130`, `+01`): the seconds since 1970, rounded down; the nanoseconds behind them",
    "`text`",
)
ALL_OF_TEXT = row("`nanoseconds(s)`", "all of it in nanoseconds, if they fit", "`text`, `range`")
ALL_OF_PAIR = row("`nanoseconds(secs, nsecs)`", "the same of two integers, `nsecs` from 0 to 999999999", "`range`")
AS_FLOAT = row("`timestamp(ns)`, `timestamp(secs, nsecs)`", "the seconds since 1970 as a float64", "`range`")
OF_FLOAT = row(
    "`seconds(t)`, `fraction(t)`, `nanoseconds(t)`",
    "of such a float: the seconds, rounded down; the nanoseconds behind them, rounded to the nearest; all of it in nanoseconds",
    "`range`",
)

FUNCTIONS = (
    of_moments(
        "iso8601",
        Texts(("integer", "integer"), TEXT, optional=1),
        _lower_iso8601,
        _nanoseconds_of,
        undone_by(nanoseconds=_dated_again, seconds=_whole_again),
        AS_TEXT,
        undoes=_whole_moment,
        split=_split,
    ),
    of_moments(
        "timestamp",
        Texts(("integer", "integer"), FLOAT64, optional=1),
        _lower_timestamp,
        _nanoseconds_of,
        replace(undone_by(nanoseconds=loses(FLOATING), seconds=loses("large integers are rounded to a float")), of_several=FLOATING),
        AS_FLOAT,
        undoes=_whole_moment,
        split=_split,
    ),
    of_moments(
        "seconds",
        OF_MOMENT,
        _lower_seconds,
        ByType(_moment_of_seconds),
        undone_by(iso8601=_spelt_again, timestamp=loses("what is behind the point is dropped")),
        (*OF_TEXT, *OF_FLOAT),
        undoes=partial(_part_again, 0),
        whole=Whole("fraction", _below, _joined),
    ),
    of_moments("fraction", OF_MOMENT, _lower_fraction, SEVERAL, undone_by(), (*OF_TEXT, *OF_FLOAT), undoes=partial(_part_again, 1)),
    of_moments(
        "nanoseconds",
        _type_nanoseconds,
        _lower_nanoseconds,
        ByType(_moment_of),
        undone_by(iso8601=_spelt_again, timestamp=_timed_again),
        (*ALL_OF_TEXT, *ALL_OF_PAIR, *OF_FLOAT),
        split=_split_number,
    ),
)
