"""Texts in relations: the sum of a text that is written down, and the calls whose function depends on the type of the field.

The inverse of `text(n)` is `integer` or `number`, that of `nanoseconds(s)` is `iso8601` or `timestamp`, and that of `until_nul(b)` fills a
field that has one size. The type is known when rules are resolved: until then such a call has one of the names below.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.model.expr import Binary, Call, Choice, Literal, Nearest, Unary
from rosetta_jit.model.types import Array, Bytes, Float, Int
from rosetta_jit.model.walk import rebuilt

if TYPE_CHECKING:
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.types import Type

WRITTEN, FILLED, MOMENT = "(written)", "(filled)", "(moment)"
"""The number that a text spells; a text as large as its field; a point in time. No mapping can write such names."""

SHOWN = {WRITTEN: "number", FILLED: "padded", MOMENT: "iso8601"}
"""What they are called where the type of the field does not matter."""


def without(sum_: Binary, value: Expr) -> tuple[Expr, Expr] | None:
    """The field of a sum of texts of which one is written down."""
    match sum_:
        case Binary("+", Literal(str()) as start, inner, span):
            return inner, Call("behind", (value, start), span)
        case Binary("+", inner, Literal(str()) as end, span):
            return inner, Call("before", (value, end), span)
        case _:
            return None


def for_comparison(call: Call) -> Call:
    """A call that was turned round where no field asks for a type: what it is compared with may be any number."""
    return replace(call, function=SHOWN[call.function]) if call.function in (WRITTEN, MOMENT) else call


def as_written(expr: Expr) -> Expr:
    """An expression that was turned round, as a person reads it."""
    inner = rebuilt(expr, as_written)
    match inner:
        case Call(name, arguments, span) if name in SHOWN:
            return Call(SHOWN[name], arguments, span)
        case _:
            return inner


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
        case Call(name, arguments, span):
            inner = tuple(for_type(argument, type_) for argument in arguments)
            if name == WRITTEN:
                return Call("number" if isinstance(type_, Float) else "integer", inner, span)
            if name == MOMENT:
                return Call("timestamp" if isinstance(type_, Float) else "iso8601", inner, span)
            if name != FILLED:
                return Call(name, inner, span)
            size = type_.length if isinstance(type_, Array | Bytes) else None
            return Call("padded", (*inner, Literal(size, span)), span) if isinstance(size, int) else inner[0]
        case _:
            return expr
