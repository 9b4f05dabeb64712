"""Messages that are no structs: a number, a vector, what a typedef names. Each becomes a struct of one field."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

from rosetta_jit.frameworks.orocos.layout import UNDERLYING
from rosetta_jit.model.types import Array, Bool, Bytes, Declaration, Field, Float, Int, Ref, String, Struct, Type

if TYPE_CHECKING:
    from rosetta_jit.source import Span

DATA = "data"
"""The field."""

_WIDTHS: dict[str, tuple[Literal[8, 16, 32, 64], bool]] = {
    "char": (8, True),
    "signed char": (8, True),
    "unsigned char": (8, False),
    "short": (16, True),
    "unsigned short": (16, False),
    "int": (32, True),
    "unsigned int": (32, False),
    "long": (64, True),
    "unsigned long": (64, False),
    "long long": (64, True),
    "unsigned long long": (64, False),
    "int8_t": (8, True),
    "uint8_t": (8, False),
    "int16_t": (16, True),
    "uint16_t": (16, False),
    "int32_t": (32, True),
    "uint32_t": (32, False),
    "int64_t": (64, True),
    "uint64_t": (64, False),
}

NUMBERS: Mapping[str, Bool | Int | Float] = {
    "bool": Bool("bool"),
    "float": Float(32, "float"),
    "double": Float(64, "double"),
    **{word: Int(bits, signed, word) for word, (bits, signed) in _WIDTHS.items()},
}
"""The arithmetic types of C++ on x86-64 Linux, and the aliases of <cstdint>, by their names."""

OCTETS = frozenset({"char", "unsigned char", "uint8_t", "std::byte"})
"""Arrays of these are bytes. An int8_t is a small number; a char is a part of a text."""


STRING = String("octets", "std::string")
"""RTT and typelib promise nothing about the bytes of a text."""


def array(element: Type, length: int | None = None) -> Array | Bytes:
    """A vector, or an array of fixed length."""
    if isinstance(element, Int) and element.spelling in OCTETS:
        return Bytes(element.spelling, length)
    return Array(element, length)


def wrapped(name: str, type_: Type, span: Span, enums: Mapping[str, str]) -> Struct:
    """A type as a message."""
    return Struct(name, (Field(DATA, type_, options=options_of(type_, enums), span=span),), span=span)


def options_of(type_: Type, enums: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """The options of a field: what its enum is, where that is no int. ``enums`` has the scalars of such enums by name."""
    while isinstance(type_, Array):
        type_ = type_.element
    return ((UNDERLYING, enums[type_.name]),) if isinstance(type_, Ref) and type_.name in enums else ()


def with_messages(types: Mapping[str, Declaration], enums: Mapping[str, str], span: Span) -> dict[str, Declaration]:
    """The types, and messages of one number, or of a vector of numbers, texts, structs or enums."""
    elements: dict[str, Type] = {**NUMBERS, "std::string": STRING, **{name: Ref(name) for name in types}}
    vectors = {f"std::vector<{name}>": array(type_) for name, type_ in elements.items()}
    messages = {name: wrapped(name, type_, span, enums) for name, type_ in {**NUMBERS, **vectors}.items()}
    return {**messages, **types}
