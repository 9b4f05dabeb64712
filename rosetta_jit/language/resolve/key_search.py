"""Types of elements that are known by a key: `.values[.key = "speed"]` is an element whose number is searched for.

The condition is a comparison like any other, of the key with a value, for an element whose number is a variable of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.language.functions.decisions import type_comparison
from rosetta_jit.language.limits import MAX_KEY_SHOWN
from rosetta_jit.language.resolve.defaults import text_there
from rosetta_jit.language.resolve.list_items import compared_text
from rosetta_jit.language.scope import Broken, Message, Scope, Sought, element_type, resolve_path
from rosetta_jit.language.typed import BOOL, INT64, Binary, Const, Expr, FieldStep, IndexStep, LenOf, Local, Place, Search
from rosetta_jit.model import expr as model
from rosetta_jit.model.printer import show_expr
from rosetta_jit.model.types import Array, Bytes, Map, Type
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
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
    if sought.element is None:
        place = Place(array.side, (*array.steps, IndexStep(variable)), _element_type(array, scope), step.span)
        return text_there(place, step.span)
    element = Place(array.side, (*array.steps, IndexStep(variable)), sought.element.root, step.span)
    path = model.Path(array.side, tuple(model.Member(name, step.span) for name in step.names), step.span)
    within = replace(scope, messages={**scope.messages, array.side: sought.element}, bases={**scope.bases, array.side: element})
    found = resolve_path(path, within, lambda _index, _scope: None)
    return None if isinstance(found, Broken) else text_there(found, step.span)


def _element_type(array: Place, scope: Scope) -> Type:
    """The type of the keys of an array that has nothing else."""
    assert isinstance(array.type, Array | Bytes | Map)
    return scope.messages[array.side].value_type(element_type(array.type))


def _wanted(step: model.Keyed) -> str:
    name = "".join(f".{name}" for name in step.names)
    which = f"whose `{name}` is" if name else "that is"
    if not isinstance(step.value, model.Literal | model.Name):
        return f"{which} what is looked for"
    shown = show_expr(step.value)
    return f"{which} {shown if len(shown) <= MAX_KEY_SHOWN else f'{shown[:MAX_KEY_SHOWN]}...'}"


def is_found(place: Place, message: Message) -> list[Expr]:
    """For each element on the way to a place that is known by a key: whether there is one, or several.

    Where the keys are in an array beside, the array of the elements may end before.
    """
    found: list[Expr] = []
    for number, step in enumerate(place.steps):
        if isinstance(step, IndexStep) and isinstance(step.index, Search):
            sought = replace(step.index, required=False)
            found.append(Binary("!=", sought, Const(-1, INT64), BOOL, step.span))
            if step.index.place.steps != place.steps[:number]:
                found.append(Binary("<", sought, _length(place, number, message), BOOL, step.span))
    return found


def _length(place: Place, number: int, message: Message) -> Expr:
    """How many elements the array has whose element is step ``number`` of a place."""
    last = place.steps[number - 1]
    assert isinstance(last, FieldStep)
    type_ = message.value_type(last.field.type)
    if isinstance(type_, Array) and type_.fixed is not None:
        return Const(type_.fixed, INT64)
    return LenOf(Place(place.side, place.steps[:number], type_))
