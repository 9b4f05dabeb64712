"""Numbers as literals of C, each of exactly its type."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS, SIGNED, to_bytes

if TYPE_CHECKING:
    from rosetta_jit.generate.c.printing.scope import Scope


def constant(scope: Scope, type_: nodes.Scalar, value: float, *, wide: bool = False) -> str:
    """A literal; ``wide`` where C would take it for an int and nothing around it says otherwise."""
    if type_ in FLOATS and not math.isfinite(found := as_float(type_, value)):
        width = 8 * nodes.WIDTH[type_]
        return f"{scope.calls(f'float{width}_of')}({bits_of(type_, found)})"
    return number(type_, value, wide=wide)


def number(type_: nodes.Scalar, value: float, *, wide: bool = False) -> str:
    """The literal of a number that is finite."""
    if type_ == "bool":
        return "true" if value else "false"
    if type_ in FLOATS:
        return _float(type_, value)
    whole, suffix = int(value), "u" if type_ not in SIGNED else ""
    if type_ in ("i64", "u64") and (wide or not -(2**31) < whole < 2**31):
        if whole == -(2**63):
            return "INT64_MIN"
        name = "INT64_C" if type_ == "i64" else "UINT64_C"
        return f"{name}({whole})" if whole >= 0 else f"(-{name}({-whole}))"
    if type_ == "i32" and whole == -(2**31):
        return "INT32_MIN"
    return f"{whole}{suffix}" if whole >= 0 else f"({whole})"


def bits_of(type_: nodes.Scalar, value: np.floating[Any]) -> str:
    """The literal of the integer that has a float's bits."""
    return f"UINT{8 * nodes.WIDTH[type_]}_C(0x{int.from_bytes(to_bytes(type_, value), 'little'):x})"


def as_float(type_: nodes.Scalar, value: float) -> np.floating[Any]:
    """A number as a float of that type."""
    with np.errstate(over="ignore"):
        return np.float32(value) if type_ == "f32" else np.float64(value)


def _float(type_: nodes.Scalar, value: float) -> str:
    text = str(as_float(type_, value))
    text = text if "." in text or "e" in text else f"{text}.0"
    text = f"{text}f" if type_ == "f32" else text
    return f"({text})" if text.startswith("-") else text
