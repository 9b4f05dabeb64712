"""Reductions: one value of many, which an expression with `[]` has. `min` and `max` of an array stand with those of several values."""

from __future__ import annotations

import math
from functools import partial
from typing import Literal

from rosetta_jit.catalogue import functions as words
from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Expr, Select
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import FLOAT64, bounds
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Numbers, Reduction, Row, Units, nothing
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import BOOL, INT64
from rosetta_jit.lowering.arithmetic import binary
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.reduced_elements import Elements
from rosetta_jit.model import expr as model
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Float, Int, Type

NUMBERS = Numbers((INT64, Float(32), FLOAT64))

SUM = Row("elements", "`sum(x[])`", ("numbers", "of their type, int64 for integers: added from the first to the last; 0 of none"))
MEAN = Row(
    "elements", "`mean(x[])`", ("numbers", "float64: the sum of the values as float64, divided by how many there are; `range` of none")
)
EXTREMES = Row(
    "elements",
    "`min(x[])`, `max(x[])`",
    ("numbers", "of their type, int64 for integers; NaN where one is; `range` of none"),
)
CONDITIONS = Row(
    "elements",
    "`any(c[])`, `all(c[])`, `count(c[])`",
    ("conditions", "whether one holds, whether each does: bool; how many do: int64. Of none: false, true, 0"),
)
CHOSEN = Row(
    "elements",
    "`sum(x[] where c[])`, `mean(x[] where c[])`, …",
    ("the same, and a condition", "the same of the elements for which the condition holds; the others are not computed"),
)
BITS = Row("elements", "`xor(n[])`", ("integers", "int64: exclusive or of all, 0 of none"))


# --- types ---------------------------------------------------------------------------------------------------------------


def _type_single(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    """Whatever is no expression with `[]`."""
    del arguments
    scope.problems.append(words.not_of_each(call.span, call.function))
    return None


# --- kernels -------------------------------------------------------------------------------------------------------------


def _zero(elements: Elements) -> Const:
    """0 as a number of the type of the values."""
    type_ = elements.reduce.value.type
    assert isinstance(type_, Int | Float)
    scalar = scalar_name(scalar_of(type_))
    return Const(scalar, 0.0 if isinstance(type_, Float) else 0)


def _lower_sum(elements: Elements) -> Expr:
    """The sum from the first value to the last; of integers it never wraps."""
    bits = _bits_of(elements.reduce)
    if bits <= FEW_BITS:
        return _lower_unchecked(elements, bits)
    if bits <= 32:
        return _lower_blocks(elements)
    writer, values = elements.writer, elements.values
    total = writer.var("sum", _zero(elements))
    with elements.each() as value:
        writer.assign(total, binary(writer, "+", total, value, values.where, values.line))
    return total


FEW_BITS = 16
"""So many integers of these bits that their sum takes more than 64 lie in no memory."""


def _bits_of(reduce: typed.Reduce) -> int:
    """How many bits the values have, where they are the integers of an array; else 64."""
    match reduce:
        case typed.Reduce(count=typed.LenOf(), value=typed.Convert(operand=typed.Access(type=Int(bits)), type=Int(), rule="widen")):
            return bits
        case _:
            return 64


def _lower_unchecked(elements: Elements, bits: int) -> Expr:
    """The sum, without a check of what it grows to: what is computed of some of its bits needs no others then."""
    writer, values = elements.writer, elements.values
    is_in_memory = Compare("le", elements.count, index((1 << 63 - bits) - 1))
    writer.expect(is_in_memory, "range", values.where, "a number grows beyond 64 bits", line=values.line)
    total = writer.var("sum", index(0))
    with elements.each() as value:
        writer.assign(total, Binary("add", total, value))
    return total


def _lower_blocks(elements: Elements) -> Expr:
    """The sums of blocks, each without a check, and of these."""
    writer, values = elements.writer, elements.values
    total = writer.var("sum", index(0))
    with elements.blocks() as (first, size):
        part = writer.var("part", index(0))
        with elements.each_of(first, size) as value:
            writer.assign(part, Binary("add", part, value))
        writer.assign(total, binary(writer, "+", total, part, values.where, values.line))
    return total


def _lower_mean(elements: Elements) -> Expr:
    total = _lower_sum(elements)
    return Binary("div", total, Convert("f64", elements.taken))


def lower_extreme(elements: Elements) -> Expr:
    """The least or the largest value; what is once NaN stays so."""
    writer, is_least = elements.writer, elements.reduce.function == "min"
    found = writer.var("least" if is_least else "largest", _bound(elements, above=is_least))
    with elements.each() as value:
        number = writer.let("value", value)
        replaces: Expr = Compare("lt" if is_least else "gt", number, found)
        if type_of(number) in ("f32", "f64"):
            replaces = Binary("or", replaces, Compare("ne", number, number))
        writer.assign(found, Select(replaces, number, found))
    return found


def _bound(elements: Elements, *, above: bool) -> Const:
    """A number of the type of the values that none of them is above, or below."""
    type_ = elements.reduce.value.type
    assert isinstance(type_, Int | Float)
    return Const(scalar_name(scalar_of(type_)), extreme_of(type_, above=above))


def extreme_of(type_: Type, *, above: bool) -> int | float:
    """The number of a type that no other one is above, or below."""
    if isinstance(type_, Float):
        return math.inf if above else -math.inf
    assert isinstance(type_, Int)
    return bounds(type_)[1 if above else 0]


def _lower_joined(operator: Literal["and", "or"], elements: Elements) -> Expr:
    """Whether conditions hold: each is looked at."""
    writer = elements.writer
    found = writer.var(elements.reduce.function, Const("bool", value=operator == "and"))
    with elements.each() as holds:
        writer.assign(found, Binary(operator, found, holds))
    return found


def _lower_count(elements: Elements) -> Expr:
    writer, values = elements.writer, elements.values
    found = writer.var("count", index(0))
    with elements.each() as holds:
        one = Convert("i64", holds)
        is_bounded = isinstance(elements.reduce.count, typed.LenOf)  # no array has so many elements that their number wraps
        sum_ = Binary("add", found, one) if is_bounded else writer.checked("add", found, one, values.where, line=values.line)
        writer.assign(found, sum_)
    return found


def _lower_xor(elements: Elements) -> Expr:
    found = elements.writer.var("xor", index(0))
    with elements.each() as value:
        elements.writer.assign(found, Binary("xor", found, value))
    return found


def _true(_type: Type) -> bool:
    """What a condition counts as where every one has to hold."""
    return True


# --- records -------------------------------------------------------------------------------------------------------------


def _lower_none(_call: typed.Call, _values: object) -> Expr:
    raise AssertionError("only expressions with `[]` are reduced")


of_each = partial(Function, signature=_type_single, lower=_lower_none, inverse=SEVERAL, law=NOT_FOLLOWED)
FUNCTIONS = (
    of_each("sum", rows=(SUM,), units=Units(keeps=True), reduction=Reduction(NUMBERS, _lower_sum)),
    of_each(
        "mean", rows=(MEAN,), units=Units(keeps=True), reduction=Reduction(Numbers((FLOAT64,)), _lower_mean, of_nothing="there is no value")
    ),
    *(
        of_each(name, rows=(CONDITIONS,), operation="predicate assignment", reduction=Reduction(None, lower, gives, unchosen=other))
        for name, lower, gives, other in (
            ("any", partial(_lower_joined, "or"), BOOL, nothing),
            ("all", partial(_lower_joined, "and"), BOOL, _true),
            ("count", _lower_count, INT64, nothing),
        )
    ),
    of_each("xor", rows=(BITS, CHOSEN), reduction=Reduction(Numbers((INT64,)), _lower_xor)),
)
