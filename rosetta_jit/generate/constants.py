"""What a schema gives names to besides types and fields: the constants of its structs and modules, and the values of its enums."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import cast

from rosetta_jit.kernel.nodes import Scalar
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Constant, Float, Int, NamedConstant, Schema, String, Struct
from rosetta_jit.startup.dataclass import replace

MOST_BYTES = 4000
"""Of a text: C11, 5.2.4.1 lets compilers refuse literals of more than 4,095."""

NO_MODULE = "constants"
"""Of those that stand in no module."""


def constants_of(struct: Struct) -> tuple[NamedConstant, ...]:
    """Those that are numbers or texts: the others have no literal in some language."""
    return tuple(each for each in struct.constants if _is_plain(each))


def modules_around(schema: Schema, types: Collection[str]) -> dict[str, Struct]:
    """The modules that have constants, around some types: structs of these alone, as ``lab`` of ``lab::LIMIT`` around ``lab::Arm``."""
    around = {parts[:depth] for name in types for parts in [_parts(name)] for depth in range(len(parts))}
    found = dict[str, list[NamedConstant]]()
    for full, constant in schema.constants.items():
        *module, name = _parts(full)
        if tuple(module) in around and _is_plain(constant):
            found.setdefault(full[: -len(name)].rstrip("./:") or NO_MODULE, []).append(replace(constant, name=name))
    structs = {name: Struct(name, (), doc="Constants of the module", constants=tuple(some)) for name, some in found.items()}
    return {name: struct for name, struct in structs.items() if schema.types.get(name, struct) == struct}


def _parts(name: str) -> tuple[str, ...]:
    return tuple(re.split(r"[./:]+", name))


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
