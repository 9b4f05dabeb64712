"""Rules that assign a list: its length, and item by item its elements.

`.names = ["yaw", "roll"]` is `len(.names) = 2`, `.names[0] = "yaw"` and `.names[1] = "roll"`. A long list of constants, and one whose
length is not known, is assigned in a loop.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.limits import MAX_SINGLE
from rosetta_jit.model.expr import Given, Index, Item, Len, List, Literal, Name, Path
from rosetta_jit.model.mapping import Assign, For, Relation, SetLength
from rosetta_jit.model.types import Array, Int

if TYPE_CHECKING:
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.mapping import Assignment, Rule


def spread(rule: Rule, variables: tuple[str, ...]) -> tuple[Rule, ...]:
    """The rules that a rule with a list stands for; ``variables`` are those of the loops around it."""
    match rule:
        case Assign(place=Path() as place, value=(List() | Given(type=Array())) as value):
            return _spread(rule, place, value, variables)
        case Relation(place=Path() as place, value=(List() | Given(type=Array())) as value):
            return _spread(rule, place, value, variables)
        case _:
            return (rule,)


def _spread(rule: Assignment | Relation, place: Path, value: List | Given, variables: tuple[str, ...]) -> tuple[Rule, ...]:
    match value:
        case List(items) if len(items) > MAX_SINGLE and all(isinstance(item, Literal) for item in items):
            count: Expr = Literal(len(items), value.span)
            return (_length(rule, place, count), *_loop(rule, place, value, count, variables))
        case List(items):
            single = [_item(rule, place, Literal(number, item.span), item, variables) for number, item in enumerate(items)]
            return (_length(rule, place, Literal(len(items), value.span)), *(found for each in single for found in each))
        case Given(name):
            count = Given(f"len({name})", (), Int(64), value.span)
            return (_length(rule, place, count), *_loop(rule, place, value, count, variables))


def _loop(rule: Assignment | Relation, place: Path, value: List | Given, count: Expr, variables: tuple[str, ...]) -> tuple[Rule, ...]:
    variable = next(name for name in ("item", *(f"item_{number}" for number in range(2, 100))) if name not in variables)
    index = Name(variable, value.span)
    if isinstance(value, Given):
        element = value.type.element if isinstance(value.type, Array) else value.type
        item: Expr = Given(value.name, (index,), element, value.span)
    else:
        item = Item(value, index, value.span)
    body = _item(rule, place, index, item, (*variables, variable))
    return (For(variable, Literal(0, value.span), count, body, rule.span),)


def _item(rule: Assignment | Relation, place: Path, index: Expr, value: Expr, variables: tuple[str, ...]) -> tuple[Rule, ...]:
    element = replace(place, steps=(*place.steps, Index(index, place.span)))
    return spread(replace(rule, place=element, value=value), variables)


def _length(rule: Assignment | Relation, place: Path, count: Expr) -> Rule:
    if isinstance(rule, Relation):
        return Relation(Len(place, place.span), count, rule.span)
    return SetLength(place, count, rule.span)
