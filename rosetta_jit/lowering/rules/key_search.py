"""Elements that are known by a key: one look at each element, which finds the number of the one, or that there is none or more than one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Compare, For, If, Local, Select
from rosetta_jit.kernel.terms import index
from rosetta_jit.language.places import shown_fields
from rosetta_jit.lowering.writer import block

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Expr
    from rosetta_jit.language import typed
    from rosetta_jit.lowering.evaluation import Evaluation

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
