"""Types of what is decided: comparisons, logic, and choices among values.

Two numbers are compared as arithmetic would unify them, integers of up to 64 bits exactly. Texts are compared byte by
byte, an enum with its constants, a bool with another.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve as words
from rosetta_jit.language.conversions import FLOAT64, as_int64, convert, describe, is_textual, same
from rosetta_jit.language.functions.texts import comparison, type_pieces
from rosetta_jit.language.limits import MAX_CASES, MAX_COMPARED
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import BOOL, INT64, Access, Binary, Choice, Const, Expr, IsText, Unary
from rosetta_jit.language.units.conversion import check_agree
from rosetta_jit.model import expr as model
from rosetta_jit.model.expr import Literal
from rosetta_jit.model.types import Bool, Bytes, Enum, Float, Int, String, Type
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    TypeExpr = Callable[[model.Expr, Scope], Expr | None]
    CompareTexts = Callable[[Expr, Expr, model.Binary], Expr | None]

EQUALITY = frozenset(("==", "!="))


def type_condition(expr: model.Expr, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """An expression that must be true or false."""
    typed = type_expr(expr, scope)
    return typed if typed is not None and is_condition(typed, scope) else None


def is_condition(typed: Expr, scope: Scope) -> bool:
    """Whether an expression is true or false; reported where it is not."""
    if not isinstance(typed.type, Bool):
        scope.problems.append(words.condition_needed(typed.span, describe(typed.type)))
        return False
    return True


def type_not(expr: model.Unary, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """``not operand``"""
    operand = type_condition(expr.operand, scope, type_expr)
    return None if operand is None else Unary("not", operand, BOOL, expr.span)


def type_logic(expr: model.Binary, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """``left and right``, ``left or right``"""
    left, right = (type_condition(operand, scope, type_expr) for operand in (expr.left, expr.right))
    return None if left is None or right is None else Binary(expr.operator, left, right, BOOL, expr.span)


def type_comparison(expr: model.Binary, scope: Scope, type_expr: TypeExpr, texts: CompareTexts) -> Expr | None:
    """``left == right`` and its like; ``texts`` compares those that are not all known."""
    left, right = type_expr(expr.left, scope), type_expr(expr.right, scope)
    if left is None or right is None or not check_agree(f"`{expr.operator}`", (left, right), expr.span, scope):
        return None
    if expr.operator == "differs" and not any(isinstance(each.type, Float) for each in (left, right)):
        expr = replace(expr, operator="!=")
    found = texts(left, right, expr) if expr.operator in EQUALITY else None
    if found is not None:
        return found
    found = _comparison(expr, left, right)
    if found is None:
        constant = _named(expr, scope)
        scope.problems.append(words.not_comparable(expr.span, expr.operator, describe(left.type), describe(right.type), constant))
    elif isinstance(found, IsText) and len(found.text.encode()) > MAX_COMPARED:
        scope.problems.append(words.long_text(expr.span, MAX_COMPARED))
        return None
    return found if not isinstance(found, IsText) or expr.operator == "==" else Unary("not", found, BOOL, expr.span)


def _named(expr: model.Binary, scope: Scope) -> str:
    """The constant of the message whose name a text in quotes is, beside what is no text; empty where there is none."""
    texts = [each.value for each in (expr.left, expr.right) if isinstance(each, Literal) and isinstance(each.value, str)]
    owner = scope.messages[scope.origin].root.name
    known = (each for each in scope.constants.full if each.startswith(owner)) if len(texts) == 1 else ()
    return next((each for each in known if each.endswith(f".{texts[0]}")), "")


def _comparison(expr: model.Binary, left: Expr, right: Expr) -> Expr | None:
    if isinstance(left, Const) and not isinstance(right, Const):
        return _compared(right, left, MIRRORED[expr.operator], expr)
    return _compared(left, right, expr.operator, expr)


MIRRORED: dict[str, model.Operator] = {"==": "==", "!=": "!=", "<": ">", "<=": ">=", ">": "<", ">=": "<=", "differs": "differs"}
"""The comparison that holds where the operands change places."""


def _compared(left: Expr, right: Expr, operator: model.Operator, expr: model.Binary) -> Expr | None:
    match left, right:
        case Access(place, String() | Bytes()), Const(str(text)) if operator in EQUALITY and is_textual(place.type):
            return IsText(place, text, BOOL, expr.span)
        case _ if isinstance(left.type, Bool | Enum):
            usable = operator in EQUALITY and same(left.type, right.type)
            return Binary(operator, left, right, BOOL, expr.span) if usable else None
        case _ if isinstance(left.type, Int | Float) and isinstance(right.type, Int | Float):
            pair = _numbers(left, right)
            return None if pair is None else Binary(operator, *pair, BOOL, expr.span)
        case _:
            return comparison(left, right, operator, expr.span)


def _numbers(left: Expr, right: Expr) -> tuple[Expr, Expr] | None:
    """Two numbers as one type that holds both; None where none does."""
    targets: tuple[Type, ...] = (left.type, right.type, FLOAT64)
    for target in targets:
        pair = convert(left, target), convert(right, target)
        if pair[0] is not None and pair[1] is not None:
            return pair[0], pair[1]
    whole = as_int64(left), as_int64(right)
    return None if whole[0] is None or whole[1] is None else (whole[0], whole[1])


def type_choice(expr: model.Choice, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """A choice: all its values as one type, the first that all fit without a word."""
    if len(expr.cases) > MAX_CASES:
        scope.problems.append(words.many_cases(expr.span, MAX_CASES))
        return None
    conditions = [type_condition(condition, scope, type_expr) for condition, _ in expr.cases]
    written = [value for _, value in expr.cases] + ([] if expr.otherwise is None else [expr.otherwise])
    values = [type_expr(value, scope) for value in written]
    known = [value for value in values if value is not None]
    if len(known) < len(values) or any(condition is None for condition in conditions):
        return None
    fitting = unified(known)
    if fitting is None:
        kinds = sorted({describe(value.type) for value in known})
        scope.problems.append(words.mixed_choice(expr.span, kinds))
        return None
    if not check_agree("a choice", known, expr.span, scope):
        return None
    otherwise = None if expr.otherwise is None else fitting[-1]
    cases = tuple((condition, value) for condition, value in zip(conditions, fitting, strict=False) if condition is not None)
    pieces = type_pieces(expr.pieces, scope, type_expr)
    return Choice(cases, otherwise, expr.reason, fitting[0].type, expr.span, pieces)


def unified(values: list[Expr]) -> list[Expr] | None:
    """Values as one type: the first that all fit without a word."""
    whole = [INT64] if all(isinstance(value.type, Int) for value in values) else []
    targets = [*(value.type for value in values if not isinstance(value, Const)), values[0].type, *whole, FLOAT64]
    for target in targets:
        found = [convert(value, target) for value in values]
        known = [value for value in found if value is not None]
        if len(known) == len(values):
            return known
    return None
