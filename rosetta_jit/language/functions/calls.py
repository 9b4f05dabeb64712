"""Calls: conversions, named by the type that they give, and the functions of the language.

now ()   counter ()   and what the mapping declares
int8_at … float64_at (bytes, place [, big])   byte (x, n)
int8 … uint64 (x [, saturate | wrap])      of an integer, a bool or an enum
int8 … uint64 (x [, round | truncate | saturate])     of a float
float32 float64 (x [, exact])   bool (x)   enum.name (x)
radians degrees sqrt sin cos tan asin acos atan (x) atan2 (y, x) of float64
floor ceil round (x)   abs (x)   min max (x, y, …)   align (n, quantum)   divide floor_divide modulo (x, y)   others (n, x, …)
index (.a[.key = x]) stands in `language.resolve.expressions`
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, cast

from rosetta_jit.catalogue import layouts
from rosetta_jit.catalogue import resolve as words
from rosetta_jit.language import conversions
from rosetta_jit.language.arrays.layouts import ARGUMENTS
from rosetta_jit.language.conversions import FLOAT64, as_int64, as_single, convert, describe, in_single, is_single, wrap
from rosetta_jit.language.functions.images import IMAGE_FUNCTIONS, type_image_call
from rosetta_jit.language.functions.number_bytes import NUMBERS_AT, type_byte, type_number_at
from rosetta_jit.language.functions.texts import NAMES, type_length, type_text_call
from rosetta_jit.language.typed import INT64, Call, Const, Convert, Told
from rosetta_jit.language.units.conversion import check_arguments
from rosetta_jit.model.expr import Name
from rosetta_jit.model.types import Bool, Enum, Float, Int

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rosetta_jit.language.scope import Scope
    from rosetta_jit.language.typed import ConversionRule, Expr, Function
    from rosetta_jit.model import expr as model
    from rosetta_jit.model.types import Type

    TypeExpr = Callable[[model.Expr, Scope], Expr | None]

NO_ENUMS: Mapping[str, Enum] = MappingProxyType({})
INTEGERS = ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64")
FLOATS = ("float32", "float64")
ANGULAR = ("sin", "cos", "tan", "asin", "acos", "atan", "atan2")
TOLD: dict[str, Literal["now", "number"]] = {"now": "now", "counter": "number"}
FUNCTIONS = (
    *TOLD,
    "radians",
    "degrees",
    *ANGULAR,
    "sqrt",
    "floor",
    "ceil",
    "round",
    "abs",
    "min",
    "max",
    "align",
    "divide",
    "floor_divide",
    "modulo",
    "others",
)
MAX_OTHERS = 16
"""Numbers that are left out."""


def type_call(expr: model.Call, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """The typed form of a call; ``type_expr`` types its arguments."""
    target = named_type(expr.function, scope.enums)
    if target is not None:
        scope.named_enums.update({expr.function} & scope.enums.keys())
        return _conversion(expr, target, scope, type_expr)
    if expr.function in ARGUMENTS:
        scope.problems.append(layouts.out_of_place(expr.span))
        return None
    if expr.function == "len":
        return type_length(expr, scope, type_expr)
    if expr.function in NAMES:
        return type_text_call(expr, scope, type_expr)
    if expr.function in IMAGE_FUNCTIONS:
        return type_image_call(expr, scope, type_expr)
    if expr.function == "byte":
        return type_byte(expr, scope, type_expr)
    if expr.function in NUMBERS_AT:
        return type_number_at(expr, NUMBERS_AT[expr.function], scope, type_expr)
    if expr.function not in FUNCTIONS:
        own = {*INTEGERS, *FLOATS, *FUNCTIONS, *ARGUMENTS, *NAMES, *IMAGE_FUNCTIONS, *NUMBERS_AT, "bool", "byte", "has", "index", "len"}
        known = own | {*scope.enums, *scope.functions}
        scope.problems.append(words.unknown_function(expr.span, expr.function, known))
        return None
    arguments = [type_expr(argument, scope) for argument in expr.arguments]
    typed = [argument for argument in arguments if argument is not None]
    if len(typed) < len(arguments) or not _arity(expr, scope):
        return None
    if expr.function in TOLD:
        return Told(TOLD[expr.function], INT64, expr.span)
    if not check_arguments(expr.function, typed, expr.span, scope):
        return None
    return _function(expr, typed, scope)


def named_type(name: str, enums: Mapping[str, Enum] = NO_ENUMS) -> Type | None:
    """The type that a conversion is named by."""
    if name in INTEGERS:
        bits = cast("Literal[8, 16, 32, 64]", int(name.lstrip("uint")))
        return Int(bits, signed=not name.startswith("u"))
    if name in FLOATS:
        return Float(32 if name == "float32" else 64)
    return Bool() if name == "bool" else enums.get(name)


def _conversion(expr: model.Call, target: Type, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    if not 1 <= len(expr.arguments) <= 2:
        scope.problems.append(words.arguments(expr.span, expr.function, "a value and at most a rule", len(expr.arguments)))
        return None
    value = type_expr(expr.arguments[0], scope)
    if value is None:
        return None
    rules = rules_between(value.type, target)
    if not rules:
        scope.problems.append(words.type_clash(value.span, describe(value.type), describe(target)))
        return None
    rule = _rule(expr, rules, scope)
    return None if rule is None else _converted(value, target, rule, expr, scope)


def rules_between(source: Type, target: Type) -> tuple[ConversionRule, ...]:
    """The rules by which one scalar may become the other; the first one holds where none is named."""
    match source, target:
        case Int(), Int():
            return ("exact", "saturate", "wrap")
        case Float(), Int():
            return ("exact", "round", "truncate", "saturate")
        case ((Bool() | Enum()), Int()) | (Int(), (Bool() | Enum())):
            return ("exact",)
        case ((Int() | Float()), Float()):
            return ("nearest", "exact")
        case _:
            return ()


def _rule(expr: model.Call, rules: tuple[ConversionRule, ...], scope: Scope) -> ConversionRule | None:
    if len(expr.arguments) == 1:
        return rules[0]
    named = expr.arguments[1]
    for rule in rules:
        if isinstance(named, Name) and named.name == rule:
            return rule
    scope.problems.append(words.conversion_rule(named.span, expr.function, rules))
    return None


def _converted(value: Expr, target: Type, rule: ConversionRule, expr: model.Call, scope: Scope) -> Expr | None:
    free = convert(value, target)
    if free is not None:
        known = in_single(free) if isinstance(free, Const) and is_single(target) else None
        if known is not None and isinstance(free, Const) and rule == "exact" and known.value != free.value:
            scope.problems.append(words.constant_range(value.span, repr(free.value), describe(target)))
            return None
        found = known or free
        is_declared = isinstance(found, Const) and isinstance(target, Float)  # so that what the text says holds in arithmetic, too
        return replace(found, span=expr.span, declared=True) if is_declared else replace(found, span=expr.span)
    match value, target:
        case Const(value=int(number), type=Int()), Int():
            if rule == "exact":
                scope.problems.append(words.constant_range(value.span, str(number), describe(target)))
                return None
            low, high = conversions.bounds(target)
            known = wrap(target, number) if rule == "wrap" else min(max(number, low), high)
            return Const(known, target, expr.span)
        case _:
            return Convert(value, target, rule, expr.span)


def _arity(expr: model.Call, scope: Scope) -> bool:
    found = len(expr.arguments)
    match expr.function:
        case "min" | "max":
            fits, expected = found >= 2, "two or more values"
        case "others":
            fits, expected = 2 <= found <= MAX_OTHERS + 1, f"a number and 1 to {MAX_OTHERS} that are left out"
        case "now" | "counter":
            fits, expected = found == 0, "no values"
        case "align":
            fits, expected = found == 2, "a number and a quantum"
        case "divide" | "floor_divide" | "modulo" | "atan2":
            fits, expected = found == 2, "two numbers"
        case _:
            fits, expected = found == 1, "one value"
    if not fits:
        scope.problems.append(words.arguments(expr.span, expr.function, expected, found))
    return fits


def _function(expr: model.Call, arguments: list[Expr], scope: Scope) -> Expr | None:
    targets = _candidates(expr.function)
    for target in targets:
        converted = [_argument(argument, target) for argument in arguments]
        known = [argument for argument in converted if argument is not None]
        if len(known) == len(arguments) and (not is_single(target) or any(is_single(argument.type) for argument in arguments)):
            return _folded(expr, known, target)
    wrong = next((argument for argument in arguments if _argument(argument, targets[-1]) is None), arguments[0])
    scope.problems.append(words.operand(wrong.span, expr.function, describe(wrong.type)))
    return None


def _candidates(function: str) -> tuple[Int | Float, ...]:
    """The types in which a function is computed, narrowest first."""
    match function:
        case "align" | "floor_divide" | "modulo" | "others":
            return (INT64,)
        case "abs" | "min" | "max" | "divide":
            return (INT64, Float(32), FLOAT64)
        case "floor" | "ceil" | "round":
            return (Float(32), FLOAT64)
        case _:
            return (FLOAT64,)


def _argument(value: Expr, target: Int | Float) -> Expr | None:
    """An argument as the type in which a function is computed: in float32 only what is one."""
    if isinstance(target, Int):
        return as_int64(value)
    return as_single(value) if is_single(target) else convert(value, target)


def _folded(expr: model.Call, arguments: list[Expr], target: Int | Float) -> Expr:
    function = cast("Function", expr.function)
    numbers = [argument.value for argument in arguments if isinstance(argument, Const) and isinstance(argument.value, int)]
    if isinstance(target, Int) and len(numbers) == len(arguments):
        known = _of_integers(function, numbers)
        if known is not None and conversions.holds(target, known):
            return Const(known, target, expr.span)
    return Call(function, tuple(arguments), target, expr.span)


def _of_integers(function: Function, numbers: list[int]) -> int | None:
    """What a function of integers gives; None where it refuses them."""
    match function, numbers:
        case "align", [number, quantum]:
            if number < 0:
                return None
            return number if quantum <= 1 else -(-number // quantum) * quantum
        case "min", _:
            return reduce(min, numbers)
        case "max", _:
            return reduce(max, numbers)
        case (("divide" | "floor_divide" | "modulo"), [_, 0]):
            return None
        case "divide", [number, divisor]:
            return None if number % divisor else number // divisor
        case "floor_divide", [number, divisor]:
            return number // divisor
        case "modulo", [number, divisor]:
            return number % divisor
        case "others", [number, *without]:
            return reduce(lambda number, each: number + (each <= number), sorted(set(without)), number)
        case _:
            return abs(numbers[0])
