"""Values as a place holds them: what a rule that is written for both directions knows of the other side before it is written."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.lowering.calls import rules_between
from rosetta_jit.lowering.conversions import convert
from rosetta_jit.lowering.inverse_texts import for_type
from rosetta_jit.lowering.scope import Broken, resolve_path
from rosetta_jit.lowering.typed import Convert
from rosetta_jit.lowering.units import in_unit

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.lowering.scope import Scope, Sought
    from rosetta_jit.lowering.typed import Expr
    from rosetta_jit.model import expr as model
    from rosetta_jit.model.types import Type

    TypeExpr = Callable[[model.Expr, Scope], Expr | None]
    TypeIndex = Callable[[model.Expr | Sought, Scope], Expr | None]


def type_held(expr: model.Held, scope: Scope, type_expr: TypeExpr, type_index: TypeIndex) -> Expr | None:
    """The typed form of a value in the unit and of the type of a place; what cannot be is reported where the place is set."""
    place = resolve_path(expr.place, scope, type_index)
    if isinstance(place, Broken):
        return None
    value = type_expr(for_type(expr.value, place.type), scope)
    if value is None:
        return None
    measured = in_unit(value, place, scope)
    return None if measured is None else fitted(measured, place.type)


def fitted(value: Expr, target: Type) -> Expr:
    """A number as the type of its place, by a check where it may not fit."""
    free = convert(value, target)
    if free is not None:
        return replace(free, span=value.span)
    rules = rules_between(value.type, target)
    return Convert(value, target, rules[0], value.span) if rules else value
