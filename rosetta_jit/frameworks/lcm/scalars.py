"""The primitive types of LCM by their words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.model.types import Bool, Float, Int, String

if TYPE_CHECKING:
    from rosetta_jit.model.types import Type

PRIMITIVES: dict[str, Type] = {
    "int8_t": Int(8, spelling="int8_t"),
    "int16_t": Int(16, spelling="int16_t"),
    "int32_t": Int(32, spelling="int32_t"),
    "int64_t": Int(64, spelling="int64_t"),
    "float": Float(32, "float"),
    "double": Float(64, "double"),
    "string": String("utf-8", "string"),
    "boolean": Bool("boolean"),
    "byte": Int(8, signed=False, spelling="byte"),
}

BYTE = "byte"
"""Its arrays are bytes."""

INTEGERS = frozenset(("int8_t", "int16_t", "int32_t", "int64_t"))
"""What a size can be."""

CONSTANTS = INTEGERS | {"float", "double"}
"""What a constant can be."""
