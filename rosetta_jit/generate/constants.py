"""What a schema gives names to besides types and fields: the constants of its structs, and the values of its enums."""

from __future__ import annotations

from typing import cast

from rosetta_jit.kernel.nodes import Scalar
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Constant, Float, Int, NamedConstant, String, Struct

MOST_BYTES = 4000
"""Of a text: C11, 5.2.4.1 lets compilers refuse literals of more than 4,095."""


def constants_of(struct: Struct) -> tuple[NamedConstant, ...]:
    """Those that are numbers or texts: the others have no literal in some language."""
    return tuple(each for each in struct.constants if _is_plain(each))


def scalar_of_constant(constant: NamedConstant) -> Scalar:
    """What a constant that is a number is in kernels."""
    assert isinstance(constant.type, Bool | Int | Float)
    return cast("Scalar", scalar_of(constant.type))


def number_of(constant: NamedConstant) -> float:
    """Its value."""
    assert isinstance(constant.value, int | float)
    return constant.value


def _is_plain(constant: NamedConstant) -> bool:
    match constant.type, constant.value:
        case String(), str(text):
            return len(text.encode("utf-8", "surrogateescape")) <= MOST_BYTES
        case Bool(), bool():
            return True
        case ((Int() | Float()), value):
            return _is_number(value)
        case _:
            return False


def _is_number(value: Constant) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
