"""Calls: conversions, named by the type that they give, and the functions of the language.

int8 … uint64 (x [, saturate | wrap])      of an integer, a bool or an enum
int8 … uint64 (x [, round | truncate | saturate])     of a float
float32 float64 (x [, exact])   bool (x)   enum.name (x)        of a text: the constant of that name

Functions have a record each (`language.function`), which says what they take. `has` and `index` stand in `language.resolve.expressions`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, cast

from rosetta_jit.catalogue import functions as function_words
from rosetta_jit.catalogue import groups, layouts
from rosetta_jit.catalogue import resolve as words
from rosetta_jit.language import conversions
from rosetta_jit.language.arrays.array_functions import ARGUMENTS
from rosetta_jit.language.arrays.orders import is_of_image, is_order, takes_orders, type_order
from rosetta_jit.language.conversions import as_int64, as_single, convert, describe, in_single, is_single, is_textual, same, wrap
from rosetta_jit.language.function import Function, Numbers, Texts
from rosetta_jit.language.groups import function_of, group_functions
from rosetta_jit.language.installed import names, written
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import Call, Const, ConversionRule, Convert, Expr
from rosetta_jit.language.units.conversion import check_arguments
from rosetta_jit.model import expr as model
from rosetta_jit.model.expr import Name
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Type
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.functions import texts

    TypeExpr = Callable[[model.Expr, Scope], Expr | None]
else:
    texts = Late("rosetta_jit.language.functions.texts")

NO_ENUMS: Mapping[str, Enum] = MappingProxyType({})
INTEGERS = ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64")
FLOATS = ("float32", "float64")


def type_call(expr: model.Call, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """The typed form of a call; ``type_expr`` types its arguments."""
    target = named_type(expr.function, scope.enums)
    if target is not None:
        scope.named.update({expr.function} & scope.enums.keys())
        return _conversion(expr, target, scope, type_expr)
    if expr.function in ARGUMENTS:
        if is_of_image(expr):
            return type_order(expr, scope, type_expr)
        scope.problems.append(layouts.out_of_place(expr.span))
        return None
    function = written(expr.function)
    if (several := function_of(expr)) is not None:
        scope.problems.append(groups.alone(expr.span, several.gives.name, [each.names[0] for each in several.gives.components]))
        return None
    if function is None:
        known = {*INTEGERS, *FLOATS, *names(), *group_functions(), *ARGUMENTS, "bool", "has", "index", *scope.enums, *scope.functions}
        scope.problems.append(words.unknown_function(expr.span, expr.function, known))
        return None
    if expr.where is not None and function.reduction is None:
        scope.problems.append(function_words.no_reduction(expr.span, expr.function))
        return None
    if function.reduction is not None and expr.where is not None:
        scope.problems.append(function_words.not_of_each(expr.span, expr.function))
        return None
    if function.reduction is not None and callable(function.signature):
        return function.signature(expr, [], scope)  # it has no `[]`, and what else is wrong with its argument follows from that
    ordered = takes_orders(expr.function)
    arguments = [type_order(each, scope, type_expr) if ordered and is_order(each) else type_expr(each, scope) for each in expr.arguments]
    typed = [argument for argument in arguments if argument is not None]
    return type_function(function, expr, typed, scope) if len(typed) == len(arguments) else None


def type_function(function: Function, expr: model.Call, arguments: list[Expr], scope: Scope) -> Expr | None:
    """The typed call of a function, by its signature."""
    match function.signature:
        case Numbers() as signature:
            return type_numbers(function, signature, expr, arguments, scope)
        case Texts() as signature:
            return texts.type_texts(expr, arguments, scope, signature)
        case own:
            return own(expr, arguments, scope)


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
    if isinstance(target, Enum) and is_textual(value.type):
        return _named(value, target, expr, scope)
    rules = rules_between(value.type, target)
    if not rules:
        how = "leave the conversion out: it is of this type already" if same(value.type, target) else ""
        if isinstance(value.type, Array) and isinstance(value.type.element, Int | Float) and isinstance(target, Int | Float):
            how = words.each_element(expr.function, value.span)
        scope.problems.append(words.type_clash(value.span, describe(value.type), describe(target), how))
        return None
    rule = _rule(expr, rules, scope)
    return None if rule is None else _converted(value, target, rule, expr, scope)


def _named(value: Expr, target: Enum, expr: model.Call, scope: Scope) -> Expr | None:
    """The constant that a text names."""
    if len(expr.arguments) > 1:
        scope.problems.append(words.arguments(expr.span, expr.function, "a text alone", len(expr.arguments)))
        return None
    return texts.constant_named(value, target, expr.span, scope)


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


def type_numbers(function: Function, signature: Numbers, expr: model.Call, arguments: list[Expr], scope: Scope) -> Expr | None:
    """The typed call of a function of numbers, or what it gives of those that are known."""
    least, most = signature.count
    if function.reduction is not None and len(arguments) == 1 and isinstance(arguments[0].type, Array | Bytes):
        scope.problems.append(function_words.not_of_each(expr.span, expr.function))
        return None
    if len(arguments) < least or (most is not None and len(arguments) > most):
        scope.problems.append(words.arguments(expr.span, expr.function, signature.takes, len(arguments)))
        return None
    if arguments and not check_arguments(function, arguments, expr.span, scope):
        return None
    if signature.divides and isinstance(arguments[-1], Const) and arguments[-1].value == 0:
        scope.problems.append(words.zero_division(arguments[-1].span))
        return None
    for target in signature.types:
        converted = [_argument(argument, target) for argument in arguments]
        known = [argument for argument in converted if argument is not None]
        if len(known) == len(arguments) and (not is_single(target) or any(is_single(argument.type) for argument in arguments)):
            return _folded(signature, expr, known, target)
    wrong = next((argument for argument in arguments if _argument(argument, signature.types[-1]) is None), arguments[0])
    scope.problems.append(words.operand(wrong.span, expr.function, describe(wrong.type)))
    return None


def _argument(value: Expr, target: Int | Float) -> Expr | None:
    """An argument as the type in which a function is computed: in float32 only what is one."""
    if isinstance(target, Int):
        return as_int64(value)
    return as_single(value) if is_single(target) else convert(value, target)


def _folded(signature: Numbers, expr: model.Call, arguments: list[Expr], target: Int | Float) -> Expr:
    numbers = [argument.value for argument in arguments if isinstance(argument, Const) and isinstance(argument.value, int)]
    if signature.fold is not None and isinstance(target, Int) and len(numbers) == len(arguments):
        known = signature.fold(numbers)
        if known is not None and conversions.holds(target, known):
            return Const(known, target, expr.span)
    return Call(expr.function, tuple(arguments), target, expr.span)
