"""Types of numbers within bytes.

int8_at … uint64_at float32_at float64_at (bytes, place [, big])     the number that begins there; ``big``: with its high byte
byte (number, n)                                                     byte ``n`` of a number as its type has it, the lowest first
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import number_bytes as words
from rosetta_jit.language.conversions import as_int64, describe
from rosetta_jit.language.functions.decisions import type_condition
from rosetta_jit.language.functions.images import is_bytes
from rosetta_jit.language.typed import Access, BytesCall, Const
from rosetta_jit.model.types import Bool, Float, Int

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.language.scope import Scope
    from rosetta_jit.language.typed import Expr
    from rosetta_jit.model import expr as model
    from rosetta_jit.model.types import Type

    TypeExpr = Callable[[model.Expr, Scope], Expr | None]

NUMBERS_AT: dict[str, Type] = {
    **{f"int{bits}_at": Int(bits) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}_at": Int(bits, signed=False) for bits in (8, 16, 32, 64)},
    **{f"float{bits}_at": Float(bits) for bits in (32, 64)},
}
"""The functions that read a number, and its type."""


def type_number_at(expr: model.Call, target: Type, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """A number that is read within bytes."""
    if len(expr.arguments) not in {2, 3}:
        scope.problems.append(words.arguments(expr.span, expr.function, len(expr.arguments)))
        return None
    array, place, *order = expr.arguments
    source, at = type_expr(array, scope), _integer(place, scope, type_expr)
    big = type_condition(order[0], scope, type_expr) if order else Const(value=False, type=Bool())
    if source is None or at is None or big is None:
        return None
    if not (isinstance(source, Access) and is_bytes(source.type)):
        scope.problems.append(words.no_field(array.span, expr.function, describe(source.type)))
        return None
    return BytesCall(expr.function, (source, at, big), target, expr.span)


def type_byte(expr: model.Call, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """One byte of a number."""
    if len(expr.arguments) != 2:
        scope.problems.append(words.arguments(expr.span, expr.function, len(expr.arguments)))
        return None
    value, number = type_expr(expr.arguments[0], scope), _integer(expr.arguments[1], scope, type_expr)
    if value is None or number is None:
        return None
    if not isinstance(value.type, Int | Float):
        scope.problems.append(words.no_number(value.span, describe(value.type)))
        return None
    if isinstance(number, Const) and not 0 <= int(number.value) < size_of(value.type):
        scope.problems.append(words.byte_range(number.span, size_of(value.type)))
        return None
    return BytesCall(expr.function, (value, number), Int(8, signed=False), expr.span)


def _integer(expr: model.Expr, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    value = type_expr(expr, scope)
    whole = None if value is None else as_int64(value)
    if value is not None and whole is None:
        scope.problems.append(words.no_integer(value.span, describe(value.type)))
    return whole


def size_of(type_: Type) -> int:
    """The bytes of a number."""
    assert isinstance(type_, Int | Float)
    return type_.bits // 8
