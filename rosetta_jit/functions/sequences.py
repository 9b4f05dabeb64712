"""Whole arrays of integers made of others: how much each is larger than the one before, and sums up to each."""

from __future__ import annotations

from functools import partial

from rosetta_jit.functions.forms import if_same_constants, undone_by
from rosetta_jit.functions.whole_arrays import INTEGERS, integer, of_arrays, row, typed_call, undone, zero
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.typed import INT64
from rosetta_jit.lowering.arithmetic import binary
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.made_arrays import ArrayArgument, MadeArray, Put, array_argument


def _lower_deltas(call: typed.Call, values: Evaluation) -> MadeArray:
    array = array_argument(call.arguments[0], values)
    return MadeArray(array.count, partial(_fill_deltas, array, values))


def _fill_deltas(array: ArrayArgument, values: Evaluation, put: Put) -> None:
    writer = values.writer
    last = writer.var("last", zero(array))
    with array.each() as number:
        value = writer.let("value", array.at(number))
        put(number, binary(writer, "-", integer(value), integer(last), values.where, values.line))
        writer.assign(last, value)


def _lower_sums(call: typed.Call, values: Evaluation) -> MadeArray:
    array = array_argument(call.arguments[0], values)
    return MadeArray(array.count, partial(_fill_sums, array, values))


def _fill_sums(array: ArrayArgument, values: Evaluation, put: Put) -> None:
    writer = values.writer
    total = writer.var("total", index(0))  # and not the element that is put, which would be narrowed and widened in each round
    with array.each() as number:
        sum_ = writer.let("sum", binary(writer, "+", total, integer(array.at(number)), values.where, values.line))
        put(number, sum_)
        writer.assign(total, sum_)


FUNCTIONS = (
    of_arrays(
        "deltas",
        partial(typed_call, (INTEGERS,), INT64),
        _lower_deltas,
        undone("running_sums"),
        undone_by(running_sums=if_same_constants),
        row("`deltas(a)`", "the first integer, and how much larger each is than the one before", "`range`"),
    ),
    of_arrays(
        "running_sums",
        partial(typed_call, (INTEGERS,), INT64),
        _lower_sums,
        undone("deltas"),
        undone_by(deltas=if_same_constants),
        row("`running_sums(a)`", "for each integer, the sum up to it", "`range`"),
    ),
)
