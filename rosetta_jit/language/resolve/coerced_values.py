"""What rules for both directions know of the other side before it is written: values converted to the unit and type of a place."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.language.conversions import convert, is_textual
from rosetta_jit.language.functions.calls import rules_between
from rosetta_jit.language.functions.texts import name_of
from rosetta_jit.language.scope import Broken, Scope, Sought, resolve_path
from rosetta_jit.language.typed import Binary, Convert, Expr, Local, Nearest
from rosetta_jit.language.units.conversion import in_unit
from rosetta_jit.model import expr as model
from rosetta_jit.model.expr import NEAREST, Coerced, Path
from rosetta_jit.model.expr import Binary as Operation
from rosetta_jit.model.types import Enum, Type
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    TypeExpr = Callable[[model.Expr, Scope], Expr | None]
    TypeIndex = Callable[[model.Expr | Sought, Scope], Expr | None]


def type_coerced(expr: model.Coerced, scope: Scope, type_expr: TypeExpr, type_index: TypeIndex) -> Expr | None:
    """The typed form of a value in the unit and of the type of a place; what cannot be is reported where the place is set."""
    place = resolve_path(expr.place, scope, type_index)
    if isinstance(place, Broken):
        return None
    value = type_expr(expr.value, scope)
    if value is None:
        return None
    measured = in_unit(value, place, scope)
    return None if measured is None else fitted(measured, place.type)


def type_nearest(expr: model.Nearest, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """The typed form of a solved relation: the integer nearest to a float, if the relation gives its place back."""
    value = type_expr(expr.value, scope)
    if value is None:
        return None
    again = Coerced(expr.place, expr.again, expr.span) if isinstance(expr.place, Path) else expr.again
    check = type_expr(Operation("==", expr.place, again, expr.span), replace(scope, values={NEAREST: expr.type}))
    return Nearest(value, Local(NEAREST, expr.type), check, expr.type, expr.span) if isinstance(check, Binary) else None


def fitted(value: Expr, target: Type) -> Expr:
    """A value as the type of its place, by a check where it may not fit: a number as another one, a constant as its name."""
    if isinstance(value.type, Enum) and is_textual(target):
        return name_of(value, value.span)
    free = convert(value, target)
    if free is not None:
        return replace(free, span=value.span)
    rules = rules_between(value.type, target)
    return Convert(value, target, rules[0], value.span) if rules else value
