"""Bits of an integer as its digits, which packing puts together: `.w & 15` is `modulo(.w, 16)`, and `.w >> 4` is `floor_divide(.w, 16)`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.inverse import CONVERSIONS
from rosetta_jit.model.expr import Binary, Call, Literal, Path
from rosetta_jit.model.mapping import For, Relation, When
from rosetta_jit.model.types import Int

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.mapping import Rule

MOST_BITS = 62
"""The largest power of two that is an int64."""


def with_digits(rules: tuple[Rule, ...], type_of: TypeOf) -> tuple[Rule, ...]:
    """Rules whose relations have digits in place of bits."""
    return tuple(_with_digits(rule, type_of) for rule in rules)


def _with_digits(rule: Rule, type_of: TypeOf) -> Rule:
    match rule:
        case Relation(Path(), value):  # lengths stay as they are written, to be equal to the ends of loops
            return replace(rule, value=_digits(value, type_of))
        case For(body=body):
            return replace(rule, body=with_digits(body, type_of))
        case When(then=then, otherwise=otherwise):
            return replace(rule, then=with_digits(then, type_of), otherwise=with_digits(otherwise, type_of))
        case _:
            return rule


def _digits(expr: Expr, type_of: TypeOf) -> Expr:
    match expr:
        case Call(function, (value, *rest)) if function in CONVERSIONS:
            return replace(expr, arguments=(_digits(value, type_of), *rest))
        case Binary("&", value, Literal(int(mask))) | Binary("&", Literal(int(mask)), value) if 0 < mask < 1 << MOST_BITS:
            if mask & (mask + 1) == 0 and _is_computed_with(value, type_of):
                return Call("modulo", (_digits(value, type_of), Literal(mask + 1, expr.span)), expr.span)
        case Binary(">>", value, Literal(int(count))) if 0 < count <= MOST_BITS and _is_computed_with(value, type_of):
            return Call("floor_divide", (_digits(value, type_of), Literal(1 << count, expr.span)), expr.span)
        case _:
            pass
    return expr


def _is_computed_with(value: Expr, type_of: TypeOf) -> bool:
    """Whether arithmetic takes a value: an integer, but no uint64."""
    type_ = type_of(value)
    return isinstance(type_, Int) and (type_.signed or type_.bits < 64)
