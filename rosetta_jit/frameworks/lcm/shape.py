"""The primitive types of LCM by their words; and what a field was declared with, back from its type: the word, and its sizes."""

from __future__ import annotations

from rosetta_jit.model import expr
from rosetta_jit.model.types import Array, Bool, Bytes, Field, Float, Int, Ref, String, Type
from rosetta_jit.startup.dataclass import dataclass

SIZES = "sizes"
"""The option of a field that keeps its sizes as they were written, where constant ones were not plain decimals."""

Size = int | str
"""A number, or the name of the field that tells it."""


@dataclass(frozen=True, slots=True)
class Shape:
    """The element of a field and its sizes, from the outermost dimension to the innermost. ``primitive`` has a word as its type."""

    type: str
    primitive: bool
    sizes: tuple[Size, ...]


def shape_of(field: Field) -> Shape:
    """The shape of a field of an LCM struct."""
    sizes: list[Size] = []
    type_ = field.type
    while isinstance(type_, Array):
        sizes.append(_size(type_.length))
        type_ = type_.element
    match type_:
        case Ref(name):
            return Shape(name, primitive=False, sizes=tuple(sizes))
        case Bytes(word, length):
            return Shape(word, primitive=True, sizes=(*sizes, _size(length)))
        case Bool(word) | Int(_, _, word) | Float(_, word) | String(_, word):
            return Shape(word, primitive=True, sizes=tuple(sizes))
        case _:
            raise AssertionError(field)


def written_sizes(field: Field) -> tuple[str, ...]:
    """The sizes as they stand in the text."""
    option = field.option(SIZES)
    return tuple(option.split(",")) if isinstance(option, str) else tuple(str(size) for size in shape_of(field).sizes)


def _size(length: object) -> Size:
    if isinstance(length, expr.Path):
        return ".".join(step.name for step in length.steps if isinstance(step, expr.Member))
    assert isinstance(length, int)
    return length


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
