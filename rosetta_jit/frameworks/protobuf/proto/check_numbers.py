"""Numbers and names of fields and of enums' values: in range, used once, and not reserved."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf.proto.constants import fits
from rosetta_jit.frameworks.protobuf.proto.options import flag
from rosetta_jit.frameworks.protobuf.proto.symbols import fields_of
from rosetta_jit.frameworks.protobuf.proto.tree import (
    LARGEST_FIELD_NUMBER,
    LARGEST_MESSAGE_SET_NUMBER,
    Enum,
    EnumValue,
    Field,
    Message,
    Name,
    Range,
)

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, DeclaredEnum, DeclaredMessage


PROTOBUF_OWN = Range(19000, 19999)
"""Numbers that the implementation of protobuf keeps for itself."""


def check_numbers(declared: Declarations) -> Iterator[Diagnostic]:
    """The numbers of each message and of its extensions."""
    for entry in declared.messages.values():
        yield from _ranges(entry.message)
        yield from _fields(entry)
    for extension in declared.extensions.values():
        target = declared.messages.get(extension.extendee.text[1:])
        limit = max_number(target.message) if target else LARGEST_FIELD_NUMBER
        yield from _number(extension.field, limit)


def max_number(message: Message) -> int:
    """The greatest number that a field or an extension of a message can have."""
    return LARGEST_MESSAGE_SET_NUMBER if flag(message.options, "message_set_wire_format") else LARGEST_FIELD_NUMBER


def containing(ranges: Sequence[Range], number: int) -> Range | None:
    """The range that holds a number, of some in order."""
    index = bisect_right(ranges, number, key=lambda range_: range_.first)
    return ranges[index - 1] if index and ranges[index - 1].last >= number else None


def in_order(ranges: Sequence[Range]) -> list[Range]:
    """Ranges by their first number."""
    return sorted(ranges, key=lambda range_: range_.first)


def check_overlaps(ranges: Sequence[Range], low: int, high: int) -> Iterator[Diagnostic]:
    """Ranges are not empty, hold possible numbers, and share none."""
    for range_ in ranges:
        if range_.first > range_.last:
            yield say.empty_range(range_.span, range_.first, range_.last)
        elif range_.first < low or range_.last > high:
            yield say.range_out_of_range(range_.span, low, high)
    widest = Range(low - 1, low - 1)
    for range_ in in_order([range_ for range_ in ranges if low <= range_.first <= range_.last <= high]):
        if range_.first <= widest.last:
            yield say.overlap(range_.span, range_, widest)
        widest = max(widest, range_, key=lambda item: item.last)


def repeated_names(names: Sequence[Name]) -> Iterator[Diagnostic]:
    """Reserved names stand once."""
    seen: set[str] = set()
    for name in names:
        if name.text in seen:
            yield say.reserved_twice(name)
        seen.add(name.text)


def _ranges(message: Message) -> Iterator[Diagnostic]:
    yield from check_overlaps((*message.extensions, *message.reserved), 1, max_number(message))
    yield from repeated_names(message.reserved_names)


def _fields(entry: DeclaredMessage) -> Iterator[Diagnostic]:
    message = entry.message
    reserved, extensions = in_order(message.reserved), in_order(message.extensions)
    names = {name.text for name in message.reserved_names}
    users: dict[int, Field] = {}
    for field in fields_of(message):
        yield from _number(field, LARGEST_FIELD_NUMBER)
        first = users.setdefault(field.number, field)
        if first is not field:
            yield say.repeated_number(field.number_span, field.number, first.name, entry.full)
        if containing(reserved, field.number):
            yield say.reserved_number(field.number_span, field.number, entry.full)
        if containing(extensions, field.number):
            yield say.extension_number(field.number_span, field.number, entry.full)
        if field.name.text in names:
            yield say.reserved_name(field.name, entry.full)


def _number(field: Field, limit: int) -> Iterator[Diagnostic]:
    if not 1 <= field.number <= limit:
        yield say.number_out_of_range(field.number_span, field.number, limit)
    elif PROTOBUF_OWN.first <= field.number <= PROTOBUF_OWN.last:
        yield say.number_of_protobuf(field.number_span, field.number)


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
