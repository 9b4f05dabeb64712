"""Names of values in C's headers: an enum for each of the schema's, and a macro for each constant of a struct."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Namespace, class_name
from rosetta_jit.generate.c.printing.literals import as_float, bits_of, number
from rosetta_jit.generate.c.texts import comment, literal
from rosetta_jit.generate.c.words import C_TYPES, RESERVED
from rosetta_jit.generate.constants import constants_of, number_of, scalar_of_constant
from rosetta_jit.generate.inner_types import reached_types
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.nodes import WIDTH
from rosetta_jit.model.types import Enum, NamedConstant

if TYPE_CHECKING:
    from rosetta_jit.generate.unit import Unit

NOT_FINITE = "((union {{ uint{width}_t bits; {type} number; }}){{ {bits} }}.number)"
"""A float that has no literal: C's headers for machines without a library have no name for it."""


def named_values(unit: Unit, words: frozenset[str]) -> str:
    """The definitions, `UNIT_TYPE_NAME`; none is called as another word of the header."""
    types, names = Namespace(frozenset()), Namespace(RESERVED | words)
    parts = list[str]()
    for name in reached_types(unit):
        declared, prefix = unit.schema.types[name], f"{unit.name}_{class_name(types, name)}"
        if isinstance(declared, Enum):
            values = [
                f"    {names.identifier(f'{prefix}_{each}')} = {value if value > -(2**31) else 'INT32_MIN'},"
                for each, value in declared.values
            ]
            parts.append("\n".join([comment(f"Values of {name}."), "enum {", *values, "};"]) if values else "")
        elif lines := [*_macros(prefix, constants_of(declared), names)]:
            parts.append("\n".join([comment(f"Constants of {name}."), *lines]))
    return "".join(f"{each}\n\n" for each in parts if each)


def _macros(prefix: str, constants: tuple[NamedConstant, ...], names: Namespace) -> Iterator[str]:
    for each in constants:
        said = f" {comment(each.doc)}" if each.doc else ""
        yield f"#define {names.identifier(f'{prefix}_{each.name}')} {value_of(each) or _not_finite(each)}{said}"


def value_of(constant: NamedConstant) -> str:
    """The literal, in C and C++; empty for a float that has none."""
    if isinstance(constant.value, str):
        return literal(constant.value)
    scalar, value = scalar_of_constant(constant), number_of(constant)
    has_literal = scalar not in FLOATS or math.isfinite(as_float(scalar, value))
    return number(scalar, value, wide=True) if has_literal else ""


def _not_finite(constant: NamedConstant) -> str:
    scalar = scalar_of_constant(constant)
    bits = bits_of(scalar, as_float(scalar, number_of(constant)))
    return NOT_FINITE.format(width=8 * WIDTH[scalar], type=C_TYPES[scalar], bits=bits)
