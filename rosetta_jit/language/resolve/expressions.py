"""Types of expressions: model expression → typed expression, every conversion made explicit.

Integers are computed in int64, where `/` and `%` truncate; two float32 in float32, and all else in float64. What
cannot be typed is reported and gives None; whoever asked stops there, so that one mistake makes one report.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.catalogue import fields
from rosetta_jit.catalogue import resolve as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.arrays.parts import is_reduction
from rosetta_jit.language.constants import constant_of
from rosetta_jit.language.conversions import FLOAT64, as_int64, as_single, convert, describe, in_single, is_single, is_textual
from rosetta_jit.language.functions.calls import type_call
from rosetta_jit.language.groups import group_of
from rosetta_jit.language.installed import written
from rosetta_jit.language.resolve.defaults import length_there, text_there
from rosetta_jit.language.scope import Broken, Scope, Sought, members_of, resolve_path
from rosetta_jit.language.typed import BOOL, INT64, Binary, Const, Expr, FieldStep, Has, IndexStep, Local, Search, Unary
from rosetta_jit.language.units.conversion import check_agree
from rosetta_jit.model import expr as model
from rosetta_jit.model.mapping import OF_WIRES
from rosetta_jit.model.types import Array, Bytes, Float, Int, Map, Optional, String, Union
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.language.functions import decisions, texts, user_functions
    from rosetta_jit.language.resolve import coerced_values, groups, key_search, list_items, reductions
else:
    decisions, texts, user_functions = late("rosetta_jit.language.functions", "decisions", "texts", "user_functions")
    coerced_values, groups = late("rosetta_jit.language.resolve", "coerced_values", "groups")
    key_search, list_items, reductions = late("rosetta_jit.language.resolve", "key_search", "list_items", "reductions")

CONSTANTS = {"pi": math.pi}
SUMS = frozenset("+-%")
SHIFTS = frozenset(("<<", ">>"))
MOST_BITS = 63
"""By which an int64 is shifted."""


def type_expr(expr: model.Expr, scope: Scope) -> Expr | None:
    """The typed form of an expression, or None where it has none; the problems are in the scope."""
    match expr:
        case model.Literal():
            return constant_of(expr.value, expr.type, expr.span)
        case model.Name():
            return _name(expr, scope)
        case model.Path():
            place = resolve_path(expr, scope, type_index)
            return None if isinstance(place, Broken) else text_there(place, expr.span)
        case model.Len():
            return _length(expr, scope)
        case model.Unary("not"):
            return decisions.type_not(expr, scope, type_expr)
        case model.Unary():
            return _negative(expr, scope)
        case model.Binary(operator) if operator in model.COMPARISONS:
            return decisions.type_comparison(expr, scope, type_expr, list_items.compared_text)
        case model.Binary(operator) if operator in model.LOGIC:
            return decisions.type_logic(expr, scope, type_expr)
        case model.Binary():
            return _binary(expr, scope)
        case model.Call(function) if function in scope.functions:
            return user_functions.type_host_call(expr, scope.functions[function], scope, type_expr)
        case model.Call("has" | "index" as function, (model.Path() as path,)):
            return _presence(path, expr.span, scope) if function == "has" else _number_of(path, expr.span, scope)
        case model.Call():
            return reductions.type_reduction(expr, scope, type_expr) if is_reduction(expr) else type_call(expr, scope, type_expr)
        case model.Choice():
            return decisions.type_choice(expr, scope, type_expr)
        case model.List() | model.Item() | model.Given():
            return _listed(expr, scope)
        case model.Coerced() | model.Nearest():
            return (
                coerced_values.type_coerced(expr, scope, type_expr, type_index)
                if isinstance(expr, model.Coerced)
                else coerced_values.type_nearest(expr, scope, type_expr)
            )
        case _:
            assert_never(expr)


def _listed(expr: model.List | model.Item | model.Given, scope: Scope) -> Expr | None:
    if isinstance(expr, model.Item) and group_of(expr.items) is not None:
        return groups.type_component(expr, scope, type_expr, type_index)
    return list_items.type_listed(expr, scope, type_expr)


def type_integer(expr: model.Expr, scope: Scope, what: str) -> Expr | None:
    """An expression that must be an integer, as int64."""
    typed = type_expr(expr, scope)
    if typed is None:
        return None
    integer = as_int64(typed)
    if integer is None:
        scope.problems.append(words.integer_needed(typed.span, what, describe(typed.type)))
    return integer


def type_index(expr: model.Expr | Sought, scope: Scope) -> Expr | None:
    """The index of an element."""
    if isinstance(expr, Sought):
        return key_search.type_search(expr, scope, type_expr)
    return type_integer(expr, scope, "an index")


def _name(expr: model.Name, scope: Scope) -> Expr | None:
    if expr.name in scope.locals:
        return Local(expr.name + scope.suffix, INT64, expr.span, counts=expr.name in scope.counting)
    if expr.name in scope.values:
        return Local(expr.name, scope.values[expr.name], expr.span)
    if expr.name in scope.state:
        return replace(scope.state[expr.name], span=expr.span)
    if expr.name in CONSTANTS:
        return Const(CONSTANTS[expr.name], FLOAT64, expr.span)
    found = scope.constants.find(expr.name)
    if len(found) == 1:
        scope.named.add(found[0].home)
        return found[0].typed(expr.span)
    scope.problems.append(_unnamed(expr, [each.name for each in found], scope))
    return None


def _unnamed(expr: model.Name, several: list[str], scope: Scope) -> Diagnostic:
    """What is wrong with a name that stands for nothing, or for ``several`` constants."""
    if several:
        return words.ambiguous_name(expr.span, expr.name, several)
    origin = scope.messages[scope.origin]
    if expr.name in members_of(origin.root, origin.schema):
        return fields.undotted_field(expr.span, expr.name)
    if expr.name in ("index", "has") or written(expr.name) is not None:
        return words.bare_function(expr.span, expr.name)
    known = {*scope.locals, *scope.state, *CONSTANTS, *scope.constants.full}
    members = members_of(origin.root, origin.schema)
    owner = origin.root.name if words.is_compared(expr.span) else ""
    return words.unknown_name(expr.span, expr.name, known, members, owner=owner, loops=scope.locals)


def _length(expr: model.Len, scope: Scope) -> Expr | None:
    place = resolve_path(expr.path, scope, type_index)
    if isinstance(place, Broken):
        return None
    match place.type:
        case Array(length=int(length)):
            return Const(length, INT64, expr.span)
        case Array() | Bytes() | String() | Map():
            return length_there(place, expr.span)
        case other:
            scope.problems.append(fields.no_length(expr.path.span, describe(other)))
            return None


def _presence(path: model.Path, span: Span | None, scope: Scope) -> Expr | None:
    place = resolve_path(path, scope, type_index)
    if isinstance(place, Broken):
        return None
    message = scope.messages[place.side]
    if place.side == "wire" and len(place.steps) == 1 and message.root.name.startswith(OF_WIRES):
        return Has(place, span=span)
    schema, questions = message.schema, key_search.is_found(place, message)
    if any(isinstance(step, FieldStep) and isinstance(schema.resolve(step.field.type), Optional | Union) for step in place.steps):
        questions.append(Has(place, span=span))
    if questions:
        return reduce(lambda left, right: Binary("and", left, right, BOOL, span), questions)
    scope.problems.append(fields.always_there(span, describe(place.type)))
    return None


def _number_of(path: model.Path, span: Span | None, scope: Scope) -> Expr | None:
    """The number of an element that a key tells."""
    place = resolve_path(path, scope, type_index)
    if isinstance(place, Broken):
        return None
    match place.steps:
        case (*_, IndexStep(Search() as search)):
            return replace(search, span=span)
        case _:
            scope.problems.append(words.no_number_of(span))
            return None


def _negative(expr: model.Unary, scope: Scope) -> Expr | None:
    operand = type_expr(expr.operand, scope)
    if operand is None:
        return None
    if isinstance(operand, Const) and isinstance(operand.type, Int | Float) and isinstance(operand.value, int | float):
        return _folded(expr, operand, operand, -operand.value, scope)
    number = _computable(operand, "-", scope)
    wide = as_int64(number) if number is not None and isinstance(number.type, Int) else number
    return None if wide is None else Unary("-", wide, wide.type, expr.span)


def _binary(expr: model.Binary, scope: Scope) -> Expr | None:
    left, right = type_expr(expr.left, scope), type_expr(expr.right, scope)
    if left is None or right is None:
        return None
    if expr.operator == "+" and (is_textual(left.type) or is_textual(right.type)):
        return texts.concatenation(left, right, expr.span, scope)
    if isinstance(right, Const) and isinstance(right.type, Int | Float) and right.value == 0 and expr.operator in {"/", "%"}:
        scope.problems.append(words.zero_division(right.span))
        return None
    if expr.operator in SHIFTS and isinstance(right, Const) and isinstance(right.value, int) and not 0 <= right.value <= MOST_BITS:
        scope.problems.append(words.shift_range(right.span, right.value, MOST_BITS))
        return None
    match left, right:
        case Const(value=int(x), type=Int()), Const(value=int(y), type=Int()) if expr.operator == "/" and x % y:
            scope.problems.append(words.fraction(expr.span, x, y))
            return None
        case Const(value=int() | float() as x, type=Int() | Float()) as one, Const(
            value=int() | float() as y, type=Int() | Float()
        ) as other:
            if expr.operator not in model.BITWISE:
                return _folded(expr, one, other, _compute(expr.operator, x, y), scope)
        case _:
            pass
    if expr.operator in SUMS and not check_agree(f"`{expr.operator}`", (left, right), expr.span, scope):
        return None
    numbers = _computable(left, expr.operator, scope), _computable(right, expr.operator, scope)
    if numbers[0] is None or numbers[1] is None:
        return None
    pair = unify(numbers[0], numbers[1], scope)
    return None if pair is None else Binary(expr.operator, *pair, pair[0].type, expr.span)


def _computable(operand: Expr, operator: str, scope: Scope) -> Expr | None:
    """A number that can be computed with; uint64 cannot, as its values do not fit int64."""
    match operand.type:
        case Float() if operator not in model.BITWISE:
            return operand
        case Int() as type_ if type_.signed or type_.bits < 64:
            return operand
        case other:
            scope.problems.append(words.operand(operand.span, operator, describe(other)))
            return None


def unify(left: Expr, right: Expr, scope: Scope) -> tuple[Expr, Expr] | None:
    """Two numbers as the type in which they are computed: int64 of two integers, float32 of two float32, else float64.

    A constant is a float32 beside one, where one is equal to it.
    """
    if isinstance(left.type, Int) and isinstance(right.type, Int):
        pair = as_int64(left), as_int64(right)
        return None if pair[0] is None or pair[1] is None else (pair[0], pair[1])
    singles = as_single(left), as_single(right)
    if singles[0] is not None and singles[1] is not None:
        return singles[0], singles[1]
    pair = convert(left, FLOAT64), convert(right, FLOAT64)
    if pair[0] is not None and pair[1] is not None:
        return pair[0], pair[1]
    wide = left if pair[0] is None else right
    scope.problems.append(words.needs_word(wide.span, describe(wide.type), "float64", "`float64(...)` rounds to the nearest"))
    return None


def _compute(operator: model.Operator, x: float, y: float) -> float | None:
    """The value of a constant expression; None where a float overflows."""
    whole = isinstance(x, int) and isinstance(y, int)
    try:
        match operator:
            case "+":
                return x + y
            case "-":
                return x - y
            case "*":
                return x * y
            case "/":
                return int(x) // int(y) if whole else x / y
            case "%":
                return abs(int(x)) % abs(int(y)) * (-1 if x < 0 else 1) if whole else math.fmod(x, y)
            case _:
                raise AssertionError(operator)
    except OverflowError:
        return None


def _folded(expr: model.Unary | model.Binary, left: Const, right: Const, value: float | None, scope: Scope) -> Const | None:
    """What two constants come to, of the type that they have in arithmetic."""
    made = _constant(value, expr.span, scope)
    if made is None:
        return None
    made = replace(made, declared=left.declared or right.declared)
    return in_single(made) if is_single(left.type) and is_single(right.type) else made


def _constant(value: float | None, span: Span | None, scope: Scope) -> Const | None:
    match value:
        case int() if -(2**63) <= value < 2**64:
            return Const(value, Int(64, signed=value < 2**63), span)
        case float() if math.isfinite(value):
            return Const(value, FLOAT64, span)
        case _:
            target = "int64" if isinstance(value, int) else "float64"
            scope.problems.append(words.constant_range(span, "the result", target))
            return None
