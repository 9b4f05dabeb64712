"""Points in time in the rules of a mapping: seconds since 1970 and the nanoseconds behind them, put together and taken apart.

A moment is a text (`lowering.texts.dates`), a float64 of seconds, an int64 of nanoseconds, or whole seconds and nanoseconds from 0 to below
10⁹.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Binary, Compare, Const, Convert, Select, Unary
from rosetta_jit.kernel.terms import add, index, type_of
from rosetta_jit.language.functions.texts import is_textual
from rosetta_jit.lowering.texts.dates import LEAST_SECONDS, MOST_SECONDS, SECOND, read_date, split, written_date

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.kernel.ir import Expr, Local
    from rosetta_jit.language import typed
    from rosetta_jit.lowering.evaluation import Evaluation
    from rosetta_jit.lowering.texts.views import View

BEYOND = float(1 << 63)
"""The first float that is no int64."""


def dated(call: typed.TextCall, values: Evaluation) -> View:
    """`iso8601`: a moment as text."""
    seconds, nanoseconds = _numbers(call, values)
    years = Binary("and", Compare("ge", seconds, index(LEAST_SECONDS)), Compare("le", seconds, index(MOST_SECONDS)))
    _expect(values, years, "range", "a time before the year 0 or after 9999")
    return written_date(values.writer, seconds, nanoseconds)


def moment(call: typed.TextCall, values: Evaluation, placed: Callable[[typed.Expr, Evaluation], View]) -> Expr:
    """`timestamp`, `nanoseconds`, `seconds` and `fraction`: a moment as a number, or one of its two parts; ``placed`` gives texts."""
    is_text = len(call.arguments) == 1 and is_textual(call.arguments[0].type)
    seconds, nanoseconds = _of_text(placed(call.arguments[0], values), values) if is_text else _numbers(call, values)
    match call.function:
        case "seconds":
            return seconds
        case "fraction":
            return nanoseconds
        case "timestamp":
            behind = Binary("div", Convert("f64", nanoseconds), Const("f64", float(SECOND)))
            return Binary("add", Convert("f64", seconds), behind)
        case _:
            return _in_nanoseconds(seconds, nanoseconds, values)


def _numbers(call: typed.TextCall, values: Evaluation) -> tuple[Expr, Expr]:
    """The seconds and nanoseconds of the numbers that a function is given."""
    first, *others = (values.of(argument) for argument in call.arguments)
    if others:
        return _given(first, others[0], values)
    return _of_float(values.writer.let("time", first), values) if type_of(first) == "f64" else split(values.writer, first)


def _given(seconds: Expr, nanoseconds: Expr, values: Evaluation) -> tuple[Expr, Expr]:
    whole, behind = values.writer.let("time", seconds), values.writer.let("time", nanoseconds)
    within = Binary("and", Compare("ge", behind, index(0)), Compare("lt", behind, index(SECOND)))
    _expect(values, within, "range", "the nanoseconds are not less than a second")
    return whole, behind


def _of_text(view: View, values: Evaluation) -> tuple[Expr, Expr]:
    read = read_date(values.writer, view)
    _expect(values, Unary("not", read.is_none), "text", "the text is no date with a time and its offset")
    _expect(values, Unary("not", read.is_too_fine), "range", "the date is finer than nanoseconds")
    return read.seconds, read.nanoseconds


def _of_float(time: Local, values: Evaluation) -> tuple[Expr, Expr]:
    """Rounded to nanoseconds, which may make a second full. What is behind the point of a float is a float, exactly."""
    writer = values.writer
    below = writer.let("below", Unary("floor", time))
    rounded = writer.let("rounded", Unary("rint", Binary("mul", Binary("sub", time, below), Const("f64", float(SECOND)))))
    is_full = Compare("ge", rounded, Const("f64", float(SECOND)))
    whole = writer.let("whole", Select(is_full, Binary("add", below, Const("f64", 1.0)), below))
    for within in (Compare("ge", whole, Const("f64", -BEYOND)), Compare("lt", whole, Const("f64", BEYOND))):
        _expect(values, within, "range", "the seconds do not fit int64")
    behind = writer.let("behind", Convert("i64", Select(is_full, Const("f64", 0.0), rounded)))
    for within in (Compare("ge", behind, index(0)), Compare("lt", behind, index(SECOND))):
        _expect(values, within, "range", "the seconds do not fit int64")  # true anyway; said for the proof
    return writer.let("seconds", Convert("i64", whole)), behind


def _in_nanoseconds(seconds: Expr, nanoseconds: Expr, values: Evaluation) -> Expr:
    """All int64 of nanoseconds can be reached: before 1970 the nanoseconds are counted down from the next second."""
    writer = values.writer
    whole, behind = writer.let("whole", seconds), writer.let("behind", nanoseconds)
    is_before = Compare("lt", whole, index(0))
    next_ = writer.let("next", Select(is_before, index(1), index(0)))
    product = writer.checked(
        "mul", writer.checked("add", whole, next_, values.where, line=values.line), index(SECOND), values.where, line=values.line
    )
    rest = writer.let("rest", Select(is_before, add(behind, -SECOND), behind))
    return writer.checked("add", product, rest, values.where, line=values.line)


def _expect(values: Evaluation, condition: Expr, kind: str, detail: str) -> None:
    values.writer.expect(condition, kind, values.where, detail, line=values.line)
