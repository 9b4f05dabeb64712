"""Types of reductions: `sum(.a[] * .b[])` is one value of the many that its argument has, one for each element.

The argument is typed for an element whose number is a variable of its own. Arrays that it reads must be of one length, as in rules for
each element.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import functions as words
from rosetta_jit.catalogue import layouts
from rosetta_jit.language.arrays.counts import LayoutError
from rosetta_jit.language.arrays.layouts import View, view_of
from rosetta_jit.language.arrays.parts import sources_in, substituted
from rosetta_jit.language.conversions import as_int64
from rosetta_jit.language.function import Function, Reduction
from rosetta_jit.language.functions.calls import type_numbers
from rosetta_jit.language.functions.decisions import is_condition, type_condition
from rosetta_jit.language.installed import written
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import INT64, Call, Choice, Const, Expr, Local, Reduce
from rosetta_jit.model import expr as model
from rosetta_jit.model.expr import Binary, Each, Name
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.arrays import element_loops

    TypeExpr = Callable[[model.Expr, Scope], Expr | None]
else:
    element_loops = Late("rosetta_jit.language.arrays.element_loops")


def type_reduction(call: model.Call, scope: Scope, type_expr: TypeExpr) -> Reduce | None:
    """The typed form of a reduction."""
    function, name = written(call.function), f"(element{sum(name.startswith('(') for name in scope.locals)})"
    assert function is not None
    assert function.reduction is not None
    asked = () if call.where is None else (call.where,)
    try:
        views = {
            source: view_of(source) for source in dict.fromkeys(each for part in (*call.arguments, *asked) for each in sources_in(part))
        }
        elements: dict[model.Expr, model.Expr] = {source: _element(view, name, call) for source, view in views.items()}
    except LayoutError as error:
        scope.problems.append(error.problem)
        return None
    within = scope.inside(name, Const(0, INT64))
    value = type_expr(substituted(call.arguments[0], elements, Name(name)), within)
    conditions = [type_condition(substituted(each, elements, Name(name)), within, type_expr) for each in asked]
    first, *others = [view.total for view in views.values()]
    count = type_expr(first, scope)
    refused = [each for view in views.values() for each in view.refused]
    refused += [(Binary("!=", other, first, call.span), layouts.OTHER_COUNT) for other in others if other != first]
    checks = [(type_condition(condition, scope, type_expr), why) for condition, why in refused]
    known = tuple((condition, why) for condition, why in checks if condition is not None)
    number = None if count is None else as_int64(count)
    found = None if value is None else _taken(function, function.reduction, value, call, scope)
    if found is None or number is None or len(known) < len(checks) or None in conditions:
        return None
    type_ = function.reduction.gives or found.type
    reduce = Reduce(function.name, Local(name + scope.suffix), number, found, type_, known, span=call.span)
    return next((_chosen(reduce, function.reduction, condition) for condition in conditions if condition is not None), reduce)


def _chosen(reduce: Reduce, reduction: Reduction, condition: Expr) -> Reduce:
    """A reduction of the elements for which a condition holds: the others count as what changes nothing, and are not computed."""
    value = reduce.value
    other = Const(reduction.unchosen(value.type), value.type, reduce.span)
    chosen = Reduce("count", reduce.variable, reduce.count, condition, INT64, span=reduce.span)
    return replace(reduce, value=Choice(((condition, value),), other, "", value.type, reduce.span), chosen=chosen)


def _element(view: View, name: str, call: model.Call) -> model.Expr:
    """The element of a number."""
    if len(view.axes) != 1 or view.axes[0].listed is not None:
        raise LayoutError(words.in_order(call.span, call.function))
    if any(isinstance(step, Each) for step in view.rest):
        raise LayoutError(words.within_each(call.span, call.function))
    return element_loops.element_of(view, Name(name))


def _taken(function: Function, reduction: Reduction, value: Expr, call: model.Call, scope: Scope) -> Expr | None:
    """The value of an element as the function takes it: a condition, or a number of the type in which it computes."""
    if reduction.signature is None:
        return value if is_condition(value, scope) else None
    found = type_numbers(function, reduction.signature, call, [value], scope)
    return found.arguments[0] if isinstance(found, Call) else found
