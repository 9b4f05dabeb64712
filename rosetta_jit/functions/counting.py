"""Integers that sizes and numbers of elements are computed with."""

from __future__ import annotations

from functools import reduce

from rosetta_jit.kernel.nodes import Expr
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Numbers, Row
from rosetta_jit.language.limits import MAX_OTHERS
from rosetta_jit.language.typed import INT64, Call
from rosetta_jit.lowering.arithmetic import align, others
from rosetta_jit.lowering.evaluation import Evaluation

LEFT_OUT = Row(
    "numbers",
    "`others(n, i, j, …)`",
    (
        f"integers, at most {MAX_OTHERS} behind the first",
        "int64: the number of rank `n`, from 0, among those that are none of the others",
    ),
)
ALIGNED = Row(
    "numbers",
    "`align(n, q)`",
    ("integers, `n` from 0", "`n` rounded up to a multiple of `q`; with `q` of 1 or less, `n`"),
)


def _lower_others(call: Call, values: Evaluation) -> Expr:
    number, *without = [values.of(each) for each in call.arguments]
    return others(values.writer, number, without, values.where, values.line)


def _lower_align(call: Call, values: Evaluation) -> Expr:
    number, quantum = (values.of(each) for each in call.arguments)
    return align(values.writer, number, quantum, values.where, values.line)


def _fold_others(numbers: list[int]) -> int:
    number, *without = numbers
    return reduce(lambda found, each: found + (each <= found), sorted(set(without)), number)


def _fold_align(numbers: list[int]) -> int | None:
    number, quantum = numbers
    if number < 0:
        return None
    return number if quantum <= 1 else -(-number // quantum) * quantum


TAKES = f"a number and 1 to {MAX_OTHERS} that are left out"
FUNCTIONS = (
    Function("others", Numbers((INT64,), (2, MAX_OTHERS + 1), TAKES, _fold_others), _lower_others, SEVERAL, NOT_FOLLOWED, (LEFT_OUT,)),
    Function("align", Numbers((INT64,), (2, 2), "a number and a quantum", _fold_align), _lower_align, SEVERAL, NOT_FOLLOWED, (ALIGNED,)),
)
