"""Functions of numbers: roots, whole numbers, the least and the largest, and whether a float is finite, or no number."""

from __future__ import annotations

import math
from functools import partial, reduce

from rosetta_jit.functions.forms import binary_of, unary_of
from rosetta_jit.functions.reductions import EXTREMES, extreme_of, lower_extreme
from rosetta_jit.kernel.nodes import Binary, Compare, Const, Expr, Unary
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import FLOAT64
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Numbers, Reduction, Row, Units
from rosetta_jit.language.functions.calls import type_numbers
from rosetta_jit.language.installed import written
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import BOOL, INT64, Call
from rosetta_jit.lowering.arithmetic import binary
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Float
from rosetta_jit.startup.dataclass import replace

FLOATS = (Float(32), FLOAT64)
ANY = (INT64, *FLOATS)

ROOT = Row("numbers", "`sqrt(x)`", ("a number", "float64; NaN below 0"))
WHOLE = Row(
    "numbers",
    "`floor(x)`, `ceil(x)`, `round(x)`",
    ("a float, or an integer of at most 53 bits", "the whole number as a float; `round` halves to the even one"),
)
BOUNDS = Row(
    "numbers",
    "`abs(x)`, `min(x, y, …)`, `max(x, y, …)`",
    ("numbers", "of their type, int64 for integers. Of two values of which one is NaN, the second"),
)
KINDS = Row(
    "numbers",
    "`isfinite(x)`, `isnan(x)`",
    ("a float, or an integer of at most 53 bits", "bool: whether it is neither infinite nor NaN; whether it is NaN"),
)
DROPS = "drops what is below one"


def _type_kind(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    """A question about a float; its answer is a bool."""
    function = written(call.function)
    assert function is not None
    found = type_numbers(function, Numbers(FLOATS), call, arguments, scope)
    return None if found is None else replace(found, type=BOOL)


def _lower_isfinite(call: Call, values: Evaluation) -> Expr:
    size = Unary("abs", values.of(call.arguments[0]))
    return Compare("lt", size, Const(type_of(size), math.inf))


def _lower_isnan(call: Call, values: Evaluation) -> Expr:
    number = values.writer.let("value", values.of(call.arguments[0]))
    return Compare("ne", number, number)


def _lower_round(call: Call, values: Evaluation) -> Expr:
    return Unary("rint", values.of(call.arguments[0]))


def _lower_abs(call: Call, values: Evaluation) -> Expr:
    number = values.of(call.arguments[0])
    if type_of(number) != "i64":
        return Unary("abs", number)
    return Binary("max", number, binary(values.writer, "-", index(0), number, values.where, values.line))


def _fold_abs(numbers: list[int]) -> int:
    return abs(numbers[0])


def _fold_min(numbers: list[int]) -> int:
    return reduce(min, numbers)


def _fold_max(numbers: list[int]) -> int:
    return reduce(max, numbers)


FUNCTIONS = (
    Function("sqrt", Numbers((FLOAT64,)), unary_of, SEVERAL, NOT_FOLLOWED, (ROOT,)),
    Function("floor", Numbers(FLOATS), unary_of, SEVERAL, NOT_FOLLOWED, (WHOLE,), units=Units(keeps=True), remark=DROPS),
    Function("ceil", Numbers(FLOATS), unary_of, SEVERAL, NOT_FOLLOWED, (WHOLE,), units=Units(keeps=True), remark=DROPS),
    Function("round", Numbers(FLOATS), _lower_round, SEVERAL, NOT_FOLLOWED, (WHOLE,), units=Units(keeps=True), remark=DROPS),
    Function("abs", Numbers(ANY, fold=_fold_abs), _lower_abs, SEVERAL, NOT_FOLLOWED, (BOUNDS,), units=Units(keeps=True)),
    *(
        Function(name, _type_kind, lower, SEVERAL, NOT_FOLLOWED, (KINDS,), operation="predicate assignment")
        for name, lower in (("isfinite", _lower_isfinite), ("isnan", _lower_isnan))
    ),
    *(
        Function(
            name,
            Numbers(ANY, (2, None), "two or more values, or one with `[]`", fold),
            binary_of,
            SEVERAL,
            NOT_FOLLOWED,
            (BOUNDS, EXTREMES),
            units=Units(keeps=True, joins=True),
            reduction=Reduction(
                Numbers(ANY),
                lower_extreme,
                of_nothing=f"there is no value, so none is the {which}",
                unchosen=partial(extreme_of, above=name == "min"),
            ),
        )
        for name, which, fold in (("min", "least", _fold_min), ("max", "largest", _fold_max))
    ),
)
