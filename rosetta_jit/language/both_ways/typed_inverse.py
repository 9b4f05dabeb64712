"""Inverses that depend on the type of the field: `text(n)` is undone by `integer` or by `number`.

Relations are turned round before types are known. Until then such an inverse is a call that no mapping can write
(`language.function.untyped`); here it becomes what the record of its function makes of it for a type.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.function import for_field
from rosetta_jit.model.expr import Binary, Call, Choice, Nearest, Unary
from rosetta_jit.model.types import Int
from rosetta_jit.model.walk import rebuilt

if TYPE_CHECKING:
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.types import Type


def as_written(expr: Expr) -> Expr:
    """An expression that was turned round, as a person reads it."""
    inner = rebuilt(expr, as_written)
    return for_field(inner, None) if isinstance(inner, Call) else inner


def for_type(expr: Expr, type_: Type) -> Expr:
    """An expression that was turned round, for a field of a type."""
    match expr:
        case Nearest(value):
            inner = for_type(value, type_)
            return replace(expr, value=inner, type=type_) if isinstance(type_, Int) else inner
        case Choice(cases, otherwise):
            pairs = tuple((condition, for_type(chosen, type_)) for condition, chosen in cases)
            return replace(expr, cases=pairs, otherwise=None if otherwise is None else for_type(otherwise, type_))
        case Unary(_, operand):
            return replace(expr, operand=for_type(operand, type_))
        case Binary(_, left, right):
            return replace(expr, left=for_type(left, type_), right=for_type(right, type_))
        case Call(_, arguments):
            return for_field(replace(expr, arguments=tuple(for_type(argument, type_) for argument in arguments)), type_)
        case _:
            return expr
