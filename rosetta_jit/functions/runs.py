"""Runs of equal elements: their elements and their lengths, and arrays made of both."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import layouts as words
from rosetta_jit.functions.forms import undone_by
from rosetta_jit.functions.whole_arrays import ANY, FLOATS, INTEGERS, integer, of_arrays, row, typed_call, zero
from rosetta_jit.kernel.nodes import Binary, Bits, Compare, Convert, Expr, For, If, Local, Select
from rosetta_jit.kernel.terms import add, index, type_of
from rosetta_jit.language import typed
from rosetta_jit.language.function import SEVERAL
from rosetta_jit.language.typed import INT64
from rosetta_jit.lowering.arithmetic import binary, inside
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.made_arrays import ArrayArgument, MadeArray, Put, array_argument
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.model import expr as model
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    Fill = Callable[[ArrayArgument, Expr, Evaluation, Put], None]

AS_ONE = "runs of the same value come back as one, and empty ones not at all"


def _lower_repeated(call: typed.Call, values: Evaluation) -> MadeArray:
    array, counts = (array_argument(each, values) for each in call.arguments)
    writer, runs = values.writer, array.count
    values.reject(words.OTHER_COUNT, when=Compare("ne", runs, counts.count))
    total = writer.var("total", index(0))
    with counts.each() as number:
        size = writer.let("size", integer(counts.at(number)))
        writer.expect(Compare("ge", size, index(0)), "count", values.where, "a run must not be negative", line=values.line)
        writer.assign(total, binary(writer, "+", total, size, values.where, values.line))
    return MadeArray(writer.let("total", total), partial(_fill_repeated, array, counts, writer.let("total", total), values))


def _fill_repeated(array: ArrayArgument, counts: ArrayArgument, total: Expr, values: Evaluation, put: Put) -> None:
    writer = values.writer
    at = writer.var("at", index(0))
    with counts.each() as number:
        size, value = writer.let("size", integer(counts.at(number))), writer.let("value", array.at(number))
        rest = Binary("sub", total, at)
        fits = Binary("and", Compare("ge", size, index(0)), Compare("le", size, rest))
        writer.expect(fits, "count", values.where, "the runs are others than before", line=values.line)
        each = Local("i64", writer.fresh("each"))
        with writer.nested() as body:
            put(Binary("add", at, each), value)
        writer.emit(For(each.name, size, block(body)))
        writer.assign(at, Binary("add", at, size))
    writer.expect(Compare("eq", at, total), "count", values.where, "the runs are others than before", line=values.line)


@contextmanager
def _each_run(array: ArrayArgument, values: Evaluation) -> Generator[tuple[Local, Expr, Expr]]:
    """Around what is done with each element: its number, its value, and whether a run begins with it. Floats are the same to the bit."""
    writer = values.writer
    last = writer.var("last", zero(array))
    with array.each() as number:
        value = writer.let("value", array.at(number))
        word = FLOATS.get(type_of(value))
        differs = Compare("ne", value, last) if word is None else Compare("ne", Bits(word, value), Bits(word, last))
        yield number, value, writer.let("begins", Binary("or", Compare("eq", number, index(0)), differs))
        writer.assign(last, value)


def _lower_runs(fill: Fill, call: typed.Call, values: Evaluation) -> MadeArray:
    """Runs of elements that are the same."""
    array = array_argument(call.arguments[0], values)
    runs = values.together(replace(call, function="run_values", type=INT64), partial(_counted, array, values))["runs"]
    return MadeArray(runs, partial(fill, array, runs, values))


def _counted(array: ArrayArgument, values: Evaluation) -> dict[str, Expr]:
    """How many runs there are."""
    writer = values.writer
    found = writer.var("runs", index(0))
    with _each_run(array, values) as (_, _, begins):
        writer.assign(found, Binary("add", found, Convert("i64", begins)))
    return {"runs": writer.let("runs", found)}


def _fill_values(array: ArrayArgument, runs: Expr, values: Evaluation, put: Put) -> None:
    """The element of each run, which each of its elements sets."""
    writer = values.writer
    row = writer.var("run", index(-1))
    with _each_run(array, values) as (_, value, begins):
        writer.assign(row, Binary("add", row, Convert("i64", begins)))
        _put_inside(row, runs, value, (writer, put))
    _all_were_put(row, runs, values)


def _fill_lengths(array: ArrayArgument, runs: Expr, values: Evaluation, put: Put) -> None:
    """How many each run has: what its elements set counts up to that."""
    writer = values.writer
    row, first = writer.var("run", index(-1)), writer.var("first", index(0))
    with _each_run(array, values) as (number, _, begins):
        writer.assign(row, Binary("add", row, Convert("i64", begins)))
        writer.assign(first, Select(begins, number, first))
        size = add(Binary("sub", number, first), index(1))
        _put_inside(row, runs, size, (writer, put))
    _all_were_put(row, runs, values)


def _put_inside(row: Local, runs: Expr, value: Expr, out: tuple[Writer, Put]) -> None:
    """An element, if there is room for it."""
    writer, put = out
    with writer.nested() as then:
        put(row, value)
    writer.emit(If(inside(row, runs), block(then)))


def _all_were_put(row: Expr, runs: Expr, values: Evaluation) -> None:
    is_last = Compare("eq", row, add(runs, index(-1)))
    values.writer.expect(is_last, "count", values.where, "the runs are others than before", line=values.line)


def _split_runs(call: model.Call, value: model.Expr) -> tuple[tuple[model.Expr, model.Expr], tuple[model.Expr, model.Expr]]:
    array, counts = call.arguments
    return (array, model.Call("run_values", (value,), call.span)), (counts, model.Call("run_lengths", (value,), call.span))


def _runs_again(call: typed.Call) -> typed.Expr | None:
    """The array of which there are all runs."""
    match call.arguments:
        case typed.Call("run_values", (array,)), typed.Call("run_lengths", (other,)) if array == other:
            return array
        case _:
            return None


FUNCTIONS = (
    of_arrays(
        "repeated",
        partial(typed_call, (ANY, INTEGERS), None),
        _lower_repeated,
        SEVERAL,
        replace(undone_by(), of_several=AS_ONE),
        row("`repeated(a, counts)`", "each element so many times, end to end; the arrays are of one length", "`count`"),
        undoes=_runs_again,
        split=_split_runs,
    ),
    of_arrays(
        "run_values",
        partial(typed_call, (ANY,), None),
        partial(_lower_runs, _fill_values),
        SEVERAL,
        undone_by(),
        row("`run_values(a)`, `run_lengths(a)`", "of the runs of equal elements, each as long as can be: the element; how many there are"),
    ),
    of_arrays(
        "run_lengths",
        partial(typed_call, (ANY,), INT64),
        partial(_lower_runs, _fill_lengths),
        SEVERAL,
        undone_by(),
        row("`run_values(a)`, `run_lengths(a)`", "of the runs of equal elements, each as long as can be: the element; how many there are"),
    ),
)
