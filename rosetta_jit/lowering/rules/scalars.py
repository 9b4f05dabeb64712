"""Types and constants of rules as those of the kernel."""

from __future__ import annotations

from typing import TypeGuard

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Enum, Float, Int, Type

RANGES: dict[str, tuple[int, int]] = {
    "i8": (-(1 << 7), 1 << 7),
    "u8": (0, 1 << 8),
    "i16": (-(1 << 15), 1 << 15),
    "u16": (0, 1 << 16),
    "i32": (-(1 << 31), 1 << 31),
    "u32": (0, 1 << 32),
    "i64": (-(1 << 63), 1 << 63),
    "u64": (0, 1 << 64),
}
"""Least value and first one too large."""


NAMES = {scalar: f"{'u' if scalar[0] == 'u' else ''}int{scalar[1:]}" for scalar in RANGES} | {"f32": "float32", "f64": "float64"}


def scalar_type(type_: Type) -> nodes.Scalar:
    """The kernel's type of a number."""
    match type_:
        case Bool() | Int() | Float() | Enum():
            return scalar_name(scalar_of(type_))
        case _:
            raise AssertionError(type_)


def is_named(type_: Type, number: nodes.Expr) -> TypeGuard[Bool | Enum]:
    """Whether a type has some numbers alone, and it is not known which one comes."""
    return isinstance(type_, Bool | Enum) and not isinstance(number, nodes.Const) and type_of(number) != "bool"


def constant(number: float | str, scalar: nodes.Scalar) -> nodes.Const:
    """A number that the mapping writes down."""
    assert not isinstance(number, str)
    return nodes.Const(scalar, float(number) if scalar in ("f32", "f64") else int(number))


def converted_constant(value: nodes.Const, target: nodes.Scalar) -> nodes.Const | None:
    """A constant of another type, where that is the same number."""
    if target in ("f32", "f64"):
        return nodes.Const(target, float(value.value)) if abs(value.value) <= 1 << 24 or target == "f64" else None
    if target in RANGES and float(value.value).is_integer():
        low, high = RANGES[target]
        return nodes.Const(target, int(value.value)) if low <= value.value < high else None
    return None
