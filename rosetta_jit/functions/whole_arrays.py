"""What functions of whole arrays share: their types, and their records. They take an array as it lies, and make another one."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import layouts as words
from rosetta_jit.kernel.nodes import Const, Convert, Expr, Scalar
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.language import typed
from rosetta_jit.language.function import Function, Row
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import INT64
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.made_arrays import UINT8, ArrayArgument
from rosetta_jit.model import expr as model
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Type

if TYPE_CHECKING:
    Takes = tuple[str, Callable[[Type | None], bool]]
    """What an argument must be, and whether an array of such elements is that."""

NUMBERS, BYTES, FLAGS = "an array of integers", "bytes", "an array of bools"
SCALARS = "an array of numbers, bools or enums"
FLOATS: dict[str, Scalar] = {"f32": "u32", "f64": "u64"}
"""Floats, and what their bits are as."""


def _element(value: typed.Expr, scope: Scope) -> Type | None:
    """The type of an element of an array that is read as a whole; None of what is none."""
    if not isinstance(value, typed.Access):
        return None
    message = scope.messages[value.place.side]
    found = message.value_type(value.type)
    if isinstance(found, Bytes):
        return UINT8
    return message.value_type(found.element) if isinstance(found, Array) else None


def _is_integer(type_: Type | None) -> bool:
    return isinstance(type_, Int) and (type_.signed or type_.bits < INT64.bits)


def _is_octet(type_: Type | None) -> bool:
    return type_ == UINT8


def _is_flag(type_: Type | None) -> bool:
    return isinstance(type_, Bool)


def _is_scalar(type_: Type | None) -> bool:
    return isinstance(type_, Bool | Enum | Float | Int)


def typed_call(
    takes: tuple[Takes, ...], gives: Type | None, call: model.Call, arguments: list[typed.Expr], scope: Scope
) -> typed.Expr | None:
    """The typed call of a function of so many arrays; without ``gives`` its elements are of the type that the first one has."""
    order = arguments[1:] if takes[0][0] in (BYTES, FLAGS) else []
    is_order = len(order) <= 1 and all(isinstance(each, typed.Const) and isinstance(each.value, bool) for each in order)
    elements = [_element(each, scope) for each in arguments[: len(takes)]]
    is_good = all(each(element) for (_, each), element in zip(takes, elements, strict=False))
    if len(arguments) - len(order) != len(takes) or not is_order or not is_good:
        scope.problems.append(words.whole_arrays(call.span, call.function, [what for what, _ in takes]))
        return None
    element = gives or elements[0]
    return None if element is None else typed.Call(call.function, tuple(arguments), Array(element), call.span)


def integer(value: Expr) -> Expr:
    """An integer as i64."""
    return value if type_of(value) == "i64" else Convert("i64", value)


def zero(array: ArrayArgument) -> Const:
    """The zero of an array's elements."""
    assert isinstance(array.element, Bool | Enum | Float | Int)
    scalar = scalar_name(scalar_of(array.element))
    return Const(scalar, value=False if scalar == "bool" else 0.0 if scalar in FLOATS else 0)


def undone(other: str) -> Callable[[model.Call, model.Expr], tuple[model.Expr, model.Expr]]:
    """The array of a call is what another function makes of its value, with the same order of bits."""

    def solved(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
        array, *order = call.arguments
        return array, model.Call(other, (value, *order), call.span)

    return solved


def row(forms: str, gives: str, kind: str = "") -> tuple[Row]:
    """A row of the table of arrays: what a call gives, and the kind of error where it cannot."""
    return (Row("arrays", forms, (gives, kind)),)


INTEGERS, OCTETS, BITS, ANY = (NUMBERS, _is_integer), (BYTES, _is_octet), (FLAGS, _is_flag), (SCALARS, _is_scalar)
of_arrays = partial(Function, operation="array reorder")
