"""Values that take a loop to compute, and are the same in each round of another loop: they are computed once, before it.

What cannot fail is computed before the loop. A reduction that can fail is computed in the first round that asks for it, so that a loop
without rounds, and a round that does not ask, fail as they would alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import Const
from rosetta_jit.language import typed
from rosetta_jit.language.walk import expressions_of, parts
from rosetta_jit.lowering.evaluation import Awaited, Evaluation
from rosetta_jit.model.expr import COMPARISONS, LOGIC
from rosetta_jit.model.types import Float
from rosetta_jit.model.walk import every_rule
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.lowering.rules import reductions
else:
    reductions = Late("rosetta_jit.lowering.rules.reductions")


def look_ahead(rules: tuple[typed.Rule, ...], values: Evaluation) -> None:
    """Before a loop over rules."""
    look_ahead_of(tuple(expr for rule in every_rule(rules) for expr in expressions_of(rule)), values)


def look_ahead_of(exprs: tuple[typed.Expr, ...], values: Evaluation) -> None:
    """Before a loop that computes some expressions."""
    for each in (part for expr in exprs for part in parts(expr)):
        if not all(name in values.variables for name in _free_variables(each)):
            continue
        if isinstance(each, typed.Search) and _finds(each):
            values.of(replace(each, required=False))
        elif isinstance(each, typed.Reduce) and _reduces(each):
            values.of(replace(each, required=False, refused=()))
        elif isinstance(each, typed.Reduce) and each not in values.awaited:
            known = values.writer.var("known", Const("bool", value=False))
            values.awaited[each] = Awaited(known, values.writer.var("reduced", reductions.zero_of(each)), values.writer.block)


def _finds(search: typed.Search) -> bool:
    """Whether a search cannot fail: for a text or number that is written down, as the key of an array of the message itself."""
    match search.condition:
        case typed.IsText():
            return _is_plain(search.place)
        case typed.Binary(_, typed.Access(), typed.Const()):
            return _is_plain(search.place)
        case _:
            return False


def _reduces(reduce: typed.Reduce) -> bool:
    """Whether a reduction of as many elements as there are cannot fail, but where there must be one."""
    is_sum_of_integers = reduce.function == "sum" and not isinstance(reduce.type, Float)
    plain_count = isinstance(reduce.count, typed.LenOf) and _is_plain(reduce.count.place)
    return plain_count and not reduce.refused and not is_sum_of_integers and _computes(reduce.value, reduce)


def _computes(value: typed.Expr, reduce: typed.Reduce) -> bool:
    """Whether a value of an element cannot fail."""
    match value:
        case typed.Const():
            return True
        case typed.Access(place):
            return _is_element(place, reduce)
        case typed.Unary(operator, operand):
            return (operator == "not" or isinstance(value.type, Float)) and _computes(operand, reduce)
        case typed.Convert(operand, _, "widen" | "nearest" | "wrap"):
            return _computes(operand, reduce)
        case typed.Binary(operator, left, right):
            is_safe = isinstance(value.type, Float) or operator in COMPARISONS | LOGIC
            return is_safe and _computes(left, reduce) and _computes(right, reduce)
        case _:
            return False


def _is_element(place: typed.Place, reduce: typed.Reduce) -> bool:
    """Whether a place is an element of the array that is reduced, or a field of one that need not be there."""
    if not isinstance(reduce.count, typed.LenOf):
        return False
    array = reduce.count.place.steps
    element, fields = place.steps[len(array) : len(array) + 1], place.steps[len(array) + 1 :]
    if place.steps[: len(array)] != array or element != (typed.IndexStep(reduce.variable),):
        return False
    return all(isinstance(step, typed.FieldStep) and not step.field.required for step in fields)


def _is_plain(place: typed.Place) -> bool:
    """Whether a place is reached without looking for an element."""
    return not any(isinstance(step, typed.IndexStep) for step in place.steps)


def _free_variables(expr: typed.Expr) -> set[str]:
    """The loop variables that an expression depends on."""
    found = list(parts(expr))
    bound = {each.variable for each in found if isinstance(each, typed.Search | typed.Reduce)}
    return {each.name for each in found if isinstance(each, typed.Local) and each not in bound}
