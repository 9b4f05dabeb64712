"""Types of elements that are known by a key: `.values[.key = "speed"]` is an element whose number is searched for.

The condition is a comparison like any other, of the key with a value, for an element whose number is a variable of its own.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.functions.decisions import type_comparison
from rosetta_jit.language.limits import MAX_KEY_SHOWN
from rosetta_jit.language.resolve.absent_texts import text_there
from rosetta_jit.language.resolve.list_items import compared_text
from rosetta_jit.language.scope import Broken, resolve_path
from rosetta_jit.language.typed import BOOL, INT64, Binary, Const, IndexStep, Local, Place, Search
from rosetta_jit.model import expr as model
from rosetta_jit.model.printer import show_expr

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.language.scope import Scope, Sought
    from rosetta_jit.language.typed import Expr

    TypeExpr = Callable[[model.Expr, Scope], Expr | None]


def type_search(sought: Sought, scope: Scope, type_expr: TypeExpr) -> Search | None:
    """The number of the element, which must be there once."""
    array, step = sought.array, sought.step
    name = f"(element{sum(name.startswith('(') for name in scope.locals)})"
    variable = Local(name + scope.suffix)
    key = _key(sought, variable, scope)
    value = type_expr(step.value, scope.inside(name))
    if key is None or value is None:
        return None
    compared = model.Binary("==", KEY, VALUE, step.span)
    condition = type_comparison(compared, scope, lambda mark, _: key if mark is KEY else value, compared_text)
    if condition is None:
        return None
    return Search(array, variable, condition, _wanted(step), required=True, span=step.span)


KEY, VALUE = model.Name("key"), model.Name("value")
"""What stands for the two sides of the comparison, whose types are known already."""


def _key(sought: Sought, variable: Local, scope: Scope) -> Expr | None:
    """The key of the element of a number."""
    array, step = sought.array, sought.step
    element = Place(array.side, (*array.steps, IndexStep(variable)), sought.element.root, step.span)
    path = model.Path(array.side, tuple(model.Member(name, step.span) for name in step.names), step.span)
    within = replace(scope, messages={**scope.messages, array.side: sought.element}, bases={**scope.bases, array.side: element})
    found = resolve_path(path, within, lambda _index, _scope: None)
    return None if isinstance(found, Broken) else text_there(found, step.span)


def _wanted(step: model.Keyed) -> str:
    name = "".join(f".{name}" for name in step.names)
    if not isinstance(step.value, model.Literal | model.Name):
        return f"whose `{name}` is what is looked for"
    shown = show_expr(step.value)
    return f"whose `{name}` is {shown if len(shown) <= MAX_KEY_SHOWN else f'{shown[:MAX_KEY_SHOWN]}...'}"


def is_found(place: Place) -> list[Expr]:
    """For each element on the way to a place that is known by a key: whether there is one, or several."""
    return [
        Binary("!=", replace(step.index, required=False), Const(-1, INT64), BOOL, step.span)
        for step in place.steps
        if isinstance(step, IndexStep) and isinstance(step.index, Search)
    ]
