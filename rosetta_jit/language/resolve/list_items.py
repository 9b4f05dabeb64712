"""Items of lists of the text, and parameters that are not given yet: model expression → typed expression."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import bind as words
from rosetta_jit.catalogue import resolve as names
from rosetta_jit.language.conversions import as_int64, convert, describe, is_textual
from rosetta_jit.language.functions.decisions import unified
from rosetta_jit.language.limits import MAX_ITEMS
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import BOOL, Access, Const, Expr, Given, IsText, Listed, Unary
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Array, Bytes, String, Type
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    TypeExpr = Callable[[model.Expr, Scope], Expr | None]


def type_listed(expr: model.List | model.Item | model.Given, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """The typed form of what is chosen from a list; a list by itself has none."""
    match expr:
        case model.List():
            scope.problems.append(words.list_alone(expr.span))
            return None
        case model.Item():
            return _item(expr, scope, type_expr)
        case model.Given():
            return _parameter(expr, scope, type_expr)


def _item(expr: model.Item, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """An item of a list, all items as one type: the first that all fit without a word."""
    assert isinstance(expr.items, model.List)
    written = expr.items.items
    if len(written) > MAX_ITEMS:
        scope.problems.append(words.long_list(expr.span, MAX_ITEMS))
        return None
    at = type_expr(expr.index, scope)
    items = [type_expr(item, scope) for item in written]
    known = [item for item in items if item is not None]
    if at is None or len(known) < len(items):
        return None
    index = as_int64(at)
    if index is None or not known:
        scope.problems.append(
            names.integer_needed(at.span, "an index", describe(at.type)) if index is None else words.not_a_list(expr.span)
        )
        return None
    fitting = unified(known)
    if fitting is None:
        scope.problems.append(words.mixed_list(expr.span, sorted({describe(item.type) for item in known})))
        return None
    return Listed(tuple(fitting), index, fitting[0].type, expr.span)


def _parameter(expr: model.Given, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """What stands for a parameter."""
    arguments = [type_expr(argument, scope) for argument in expr.arguments]
    indices = [index for argument in arguments if argument is not None and (index := as_int64(argument)) is not None]
    type_ = Array(expr.type) if expr.is_list else expr.type
    return Given(expr.name, tuple(indices), type_, expr.span) if len(indices) == len(arguments) else None


def compared_text(left: Expr, right: Expr, expr: model.Binary) -> Expr | None:
    """A text compared with one of a list, and two that are known."""
    match left, right:
        case Access(place, String() | Bytes()), Listed(items, index, String()) if is_textual(place.type):
            texts = tuple(IsText(place, str(item.value), BOOL, expr.span) for item in items if isinstance(item, Const))
            found = Listed(texts, index, BOOL, expr.span)
            return found if expr.operator == "==" else Unary("not", found, BOOL, expr.span)
        case Const(str(a)), Const(str(b)):
            return Const((a == b) == (expr.operator == "=="), BOOL, expr.span)
        case _:
            return None


def adapted(value: Listed, target: Type) -> Listed:
    """An item of a list whose items all fit without a word, as that type."""
    items = [convert(item, target) for item in value.items]
    known = tuple(item for item in items if item is not None)
    return replace(value, items=known, type=target) if len(known) == len(items) else value
