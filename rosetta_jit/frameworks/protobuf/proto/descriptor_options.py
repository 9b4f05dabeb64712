"""The options of descriptors, back in the form that a text gives them.

protoc stores a custom option as an extension of an options message. protobuf's Python package knows such an extension only
where its generated module was imported; elsewhere it is an unknown field, and is decoded here by its declaration.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf.limits import MAX_NAME
from rosetta_jit.frameworks.protobuf.proto.options import OPTIONS
from rosetta_jit.frameworks.protobuf.proto.tree import Option, Value, Word
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from google.protobuf.descriptor import FieldDescriptor
    from google.protobuf.descriptor_pb2 import (
        DescriptorProto,
        EnumDescriptorProto,
        FieldDescriptorProto,
        FieldOptions,
        FileDescriptorProto,
    )
    from google.protobuf.message import Message

FIELD_OPTIONS = ".google.protobuf.FieldOptions"
LABEL_REPEATED = 3
TYPE_BOOL, TYPE_ENUM = 8, 14
TEXTS = frozenset((9, 12))
SIGNED: Mapping[int, int] = {3: 64, 5: 32, 14: 32}
UNSIGNED: Mapping[int, int] = {4: 64, 13: 32}
ZIGZAG = frozenset((17, 18))
FIXED: Mapping[int, str] = {1: "d", 2: "f", 6: "Q", 7: "I", 15: "i", 16: "q"}
"""FieldDescriptorProto.Type, by how its values are written."""


@dataclass(frozen=True, slots=True)
class Extensions:
    """The extensions of `FieldOptions` by number with their absolute names, and the values of all enums."""

    fields: Mapping[int, tuple[str, FieldDescriptorProto]]
    enums: Mapping[str, Mapping[int, str]]


def extensions_in(files: Iterable[FileDescriptorProto]) -> Extensions:
    """What the custom options of fields mean, as some files declare it."""
    fields: dict[int, tuple[str, FieldDescriptorProto]] = {}
    enums: dict[str, Mapping[int, str]] = {}
    for scope, extensions, some_enums in _scopes(files):
        fields |= {field.number: (f"{scope}.{field.name}", field) for field in extensions if field.extendee == FIELD_OPTIONS}
        enums |= {f"{scope}.{enum.name}": {value.number: value.name for value in enum.value} for enum in some_enums}
    return Extensions(fields, enums)


def own_options(holder: str, options: Message) -> tuple[Option, ...]:
    """The options of an options message that descriptor.proto declares, where they are single scalars."""
    return tuple(
        Option((field.name,), _value(field, value))
        for field, value in options.ListFields()
        if not field.is_extension and OPTIONS[holder].get(field.name) not in (None, "repeated", "message", "FeatureSet")
    )


def custom_options(options: FieldOptions, extensions: Extensions) -> Iterator[Option]:
    """The custom options of a field that are single scalars; of one that comes twice, the last counts."""
    from google.protobuf.unknown_fields import UnknownFieldSet

    for field, value in options.ListFields():
        if field.is_extension and not field.is_repeated and field.message_type is None:
            yield Option((f"(.{field.full_name})",), _value(field, value))
    found: dict[int, Option] = {}
    for unknown in UnknownFieldSet(options):
        full, field = extensions.fields.get(unknown.field_number, ("", None))
        value = None if field is None else _decoded(field, unknown.data, extensions)
        if value is not None:
            found[unknown.field_number] = Option((f"({full})",), value)
    yield from found.values()


def _value(field: FieldDescriptor, value: object) -> Value:
    match value:
        case bool():
            return Word("true" if value else "false")
        case int() if field.enum_type is not None:
            return Word(field.enum_type.values_by_number[value].name)
        case str():
            return value.encode()
        case int() | float() | bytes():
            return value
        case _:
            raise AssertionError(field.full_name)


def _decoded(field: FieldDescriptorProto, data: object, extensions: Extensions) -> Value | None:
    """The value that an unknown field holds; None where it is no single scalar."""
    type_ = field.type
    match data:
        case _ if field.label == LABEL_REPEATED:
            return None
        case bytes() if type_ in TEXTS:
            return data
        case int() if type_ in FIXED:
            format_ = FIXED[type_]
            raw = data.to_bytes(8, "little")[: struct.calcsize(format_)]
            return struct.unpack("<" + format_, raw)[0]
        case int() if type_ == TYPE_BOOL:
            return Word("true" if data else "false")
        case int() if type_ == TYPE_ENUM:
            name = extensions.enums.get(field.type_name, {}).get(_signed(data, 32))
            return None if name is None else Word(name)
        case int() if type_ in SIGNED:
            return _signed(data, SIGNED[type_])
        case int() if type_ in UNSIGNED:
            return data & (1 << UNSIGNED[type_]) - 1
        case int() if type_ in ZIGZAG:
            return data >> 1 ^ -(data & 1)
        case _:
            return None


def _signed(value: int, bits: int) -> int:
    low = value & (1 << bits) - 1
    return low - (1 << bits) if low >> bits - 1 else low


def _scopes(
    files: Iterable[FileDescriptorProto],
) -> Iterator[tuple[str, Iterable[FieldDescriptorProto], Iterable[EnumDescriptorProto]]]:
    for file in files:
        package = f".{file.package}" if file.package else ""
        yield package, file.extension, file.enum_type
        for message in file.message_type:
            yield from _message_scopes(package, message)


def _message_scopes(
    outer: str, message: DescriptorProto
) -> Iterator[tuple[str, Iterable[FieldDescriptorProto], Iterable[EnumDescriptorProto]]]:
    scope = f"{outer}.{message.name}"
    if len(scope) > MAX_NAME:
        return
    yield scope, message.extension, message.enum_type
    for inner in message.nested_type:
        yield from _message_scopes(scope, inner)
