"""Values that need a look at each element of an array: reductions, and the number of the element that has a key.

What is wrong with the elements of a reduction is checked before them, where a value is asked for.
"""

from __future__ import annotations

from typing import cast

from rosetta_jit.kernel.nodes import Compare, Const, Expr, For, If, Local, Select
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.installed import functions
from rosetta_jit.language.places import shown_fields
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.reduced_elements import Elements
from rosetta_jit.lowering.writer import block
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Enum, Float, Int
from rosetta_jit.startup.dataclass import replace


def reduced(reduce: typed.Reduce, values: Evaluation) -> Expr:
    """The value that a reduction has, if it is required an error where there is none."""
    reduction = functions()[reduce.function].reduction
    assert reduction is not None
    if not reduce.required:
        count = values.writer.let("count", values.of(reduce.count))
        return cast("Expr", reduction.lower(Elements(reduce, count, values)))
    for condition, why in reduce.refused:
        values.reject(why, when=values.of(condition))
    if reduction.of_nothing:
        is_some = Compare("gt", values.of(reduce.chosen or reduce.count), index(0))
        values.writer.expect(is_some, "range", values.where, reduction.of_nothing, line=values.line)
    return values.of(replace(reduce, required=False, refused=()))


def zero_of(reduce: typed.Reduce) -> Const:
    """A number of the type of a reduction."""
    assert isinstance(reduce.type, Bool | Enum | Float | Int)
    scalar = scalar_name(scalar_of(reduce.type))
    return Const(scalar, value=False if scalar == "bool" else 0.0 if scalar in ("f32", "f64") else 0)


NONE, SEVERAL = -1, -2
"""What is found instead of a number."""


def number_in(search: typed.Search, values: Evaluation) -> Expr:
    """The number of the element; an error of kind ``index`` unless there is one, where that is required."""
    if not search.required:
        return _looked_for(search, values)
    found = values.of(replace(search, required=False))
    array = shown_fields(search.place.steps)
    for wrong, what in ((NONE, "has no element"), (SEVERAL, "has more than one element")):
        is_right = Compare("ne", found, index(wrong))
        values.writer.expect(is_right, "index", values.where, f"`{array}` {what} {search.wanted}", line=values.line)
    return found


def _looked_for(search: typed.Search, values: Evaluation) -> Local:
    writer = values.writer
    count = values.source.count(search.place, values)
    found, number = writer.var("found", index(NONE)), Local("i64", writer.fresh("element"))
    with values.source.forgetting(), writer.nested() as body:
        inner = values.with_local(search.variable.name, number)
        holds = inner.of(search.condition)
        with writer.nested() as hit:
            writer.assign(found, Select(Compare("eq", found, index(NONE)), number, index(SEVERAL)))
        writer.emit(If(holds, block(hit)))
    writer.emit(For(number.name, count, block(body)))
    return found
