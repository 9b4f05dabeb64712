"""Enums: at least one value, numbers of 32 bits, used once unless aliases are allowed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf.proto.check_numbers import check_overlaps, containing, in_order, repeated_names
from rosetta_jit.frameworks.protobuf.proto.constants import fits
from rosetta_jit.frameworks.protobuf.proto.options import flag

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, DeclaredEnum
    from rosetta_jit.frameworks.protobuf.proto.tree import Enum, EnumValue


def check_enums(declared: Declarations) -> Iterator[Diagnostic]:
    """Every enum."""
    for entry in declared.enums.values():
        enum = entry.enum
        if not enum.values:
            yield say.empty_enum(enum.name)
        elif not entry.closed and enum.values[0].number != 0:
            yield say.first_not_zero(enum.values[0].number_span, enum.values[0].number)
        yield from check_overlaps(enum.reserved, -(2**31), 2**31 - 1)
        yield from repeated_names(enum.reserved_names)
        yield from _values(entry)
        if not flag(enum.options, "allow_alias"):
            yield from _aliases(enum)


def _values(entry: DeclaredEnum) -> Iterator[Diagnostic]:
    reserved = in_order(entry.enum.reserved)
    names = {name.text for name in entry.enum.reserved_names}
    for value in entry.enum.values:
        if not fits(value.number, 32, signed=True):
            yield say.value_out_of_range(value.number_span, value.number)
        if containing(reserved, value.number):
            yield say.reserved_number(value.number_span, value.number, entry.full)
        if value.name.text in names:
            yield say.reserved_name(value.name, entry.full)


def _aliases(enum: Enum) -> Iterator[Diagnostic]:
    users: dict[int, EnumValue] = {}
    for value in enum.values:
        first = users.setdefault(value.number, value)
        if first is not value:
            yield say.alias(value.number_span, value.number, first.name)
