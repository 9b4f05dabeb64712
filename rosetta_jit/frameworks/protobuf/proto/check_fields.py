"""Labels, groups, maps, oneofs, enums, defaults and `packed`: what a field or an extension may be in its version of the language."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf import edition_diagnostics as say_edition
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.frameworks.protobuf.proto.check_numbers import containing, in_order
from rosetta_jit.frameworks.protobuf.proto.constants import WrongValueError, constant, enum_number, spelled
from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, DeclaredExtension, DeclaredField, fields_in
from rosetta_jit.frameworks.protobuf.proto.options import OPTIONS, flag
from rosetta_jit.frameworks.protobuf.proto.scalars import SCALARS, is_packable
from rosetta_jit.frameworks.protobuf.proto.tree import EDITIONS, Field, MapType, Name, Oneof, Option, Version

NO_KEYS = frozenset(("double", "float", "bytes"))
"""Scalars that a map cannot have as keys."""


def check_fields(declared: Declarations) -> Iterator[Diagnostic]:
    """The fields of each message, and all extensions."""
    for entry in declared.messages.values():
        if entry.version == "proto3" and entry.message.extensions:
            yield say.extensions_in_proto3(entry.message.extensions[0].span)
        for member in entry.message.members:
            if isinstance(member, Oneof):
                yield from _oneof(member)
        for field in fields_in(entry):
            yield from _field(field, declared)
    for extension in declared.extensions.values():
        yield from _field(extension.entry, declared)


def _oneof(oneof: Oneof) -> Iterator[Diagnostic]:
    if not oneof.fields:
        yield say.empty_oneof(oneof.name)
    for field in oneof.fields:
        if isinstance(field.type, MapType):
            yield say.map_in_oneof(field.type.span)
        elif field.label:
            yield say.label_in_oneof(field.label_span, field.label)


def _field(entry: DeclaredField, declared: Declarations) -> Iterator[Diagnostic]:
    field = entry.field
    if entry.place != "oneof":
        yield from _label(field, entry.version)
    if field.group:
        yield from _group(field, entry.version, declared)
    if isinstance(field.type, MapType):
        yield from _map(field.type)
    yield from _enum(entry, declared)
    for option in field.options:
        if option.parts == ("default",):
            yield from _default(entry, option, declared)
    if flag(field.options, "packed") and not _can_pack(field, declared):
        yield say.cannot_pack(field.name)


def _label(field: Field, version: Version) -> Iterator[Diagnostic]:
    match field.type, field.label, version:
        case (MapType(), None, _) | (_, "repeated", "proto3" | "2023" | "2024"):
            pass
        case MapType(), str(), _:
            yield say.label_on_map(field.label_span)
        case _, None, "proto2":
            yield say.missing_label(field.name)
        case _, "required", "proto3":
            yield say.required_in_proto3(field.label_span)
        case _, "optional" | "required" as label, "2023" | "2024":
            yield say_edition.label_in_edition(field.label_span, label)
        case _:
            pass


def _group(field: Field, version: Version, declared: Declarations) -> Iterator[Diagnostic]:
    if isinstance(field.type, Name) and field.type.text and field.type.text[1:] not in declared.messages:
        yield of_file.bad_descriptor(f"the group `{field.name.text}` has no message")
    if version == "proto3":
        yield say.group_in_proto3(field.name)
    if version in EDITIONS:
        yield say_edition.group_in_edition(field.name)


def _enum(entry: DeclaredField, declared: Declarations) -> Iterator[Diagnostic]:
    """What a field of an enum needs of it."""
    type_ = entry.field.type
    name = type_.value if isinstance(type_, MapType) else type_
    enum = declared.enums.get(name.text[1:])
    if enum is None:
        return
    if isinstance(type_, MapType) and enum.enum.values and enum.enum.values[0].number != 0:
        yield say.map_enum(name, enum.full)
    if enum.closed and entry.version == "proto3":
        yield say.closed_enum(entry.field.name, enum.full)
    elif enum.closed and _is_implicit(entry):
        yield say_edition.closed_implicit(entry.field.name, enum.full)


def _is_implicit(entry: DeclaredField) -> bool:
    """Whether a value of 0 means that there is none; protoc takes it so for the values of maps too."""
    listed = entry.field.label == "repeated"
    return entry.features.field_presence == "IMPLICIT" and entry.place == "message" and not listed


def _map(type_: MapType) -> Iterator[Diagnostic]:
    if type_.key.text and (type_.key.text not in SCALARS or type_.key.text in NO_KEYS):
        yield say.map_key(type_.key)


def _default(entry: DeclaredField, option: Option, declared: Declarations) -> Iterator[Diagnostic]:
    type_ = entry.field.type
    if entry.version == "proto3":
        yield say.default_in_proto3(option.span)
    elif isinstance(type_, MapType) or entry.repeated:
        yield say.default_of_many(option.span)
    elif _is_implicit(entry):
        yield say_edition.default_of_implicit(option.span)
    elif type_.text:
        yield from _default_value(type_, option, declared)


def _default_value(type_: Name, option: Option, declared: Declarations) -> Iterator[Diagnostic]:
    enum = declared.enums.get(type_.text[1:])
    try:
        if type_.text in SCALARS:
            constant(SCALARS[type_.text], option.value)
        elif enum:
            enum_number(enum.numbers, option.value)
        else:
            yield say.default_of_message(option.span)
    except WrongValueError as error:
        yield say.wrong_default(option.span, str(error.args[0]), spelled(option.value))


def _can_pack(field: Field, declared: Declarations) -> bool:
    if isinstance(field.type, MapType) or field.label != "repeated":
        return False
    word = field.type.text
    return word == "" or word[1:] in declared.enums or (word in SCALARS and is_packable(word))


OPTION_MESSAGES = frozenset(f".google.protobuf.{name}" for name in OPTIONS)


def check_extensions(declared: Declarations) -> Iterator[Diagnostic]:
    """Every extension, and every message that takes extensions alone."""
    users: dict[tuple[str, int], str] = {}
    ranges = {full: in_order(entry.message.extensions) for full, entry in declared.messages.items()}
    for extension in declared.extensions.values():
        extendee, field = extension.extendee.text, extension.field
        yield from _shape(extension, declared)
        if not extendee:
            continue
        if not containing(ranges[extendee[1:]], field.number):
            yield say.no_extension_number(field.number_span, field.number, extendee[1:])
        first = users.setdefault((extendee, field.number), extension.full)
        if first != extension.full:
            yield say.repeated_extension(field.number_span, field.number, extendee[1:], first)
    for entry in declared.messages.values():
        if entry.message.members and flag(entry.message.options, "message_set_wire_format"):
            yield say.message_set_field(entry.message.name)


def _shape(extension: DeclaredExtension, declared: Declarations) -> Iterator[Diagnostic]:
    field = extension.field
    if isinstance(field.type, MapType):
        yield say.map_extension(field.type.span)
    elif field.label == "required" and extension.entry.version == "proto2":
        yield say.required_extension(field.label_span)
    extendee = extension.extendee.text
    if extendee and extension.entry.version == "proto3" and extendee not in OPTION_MESSAGES:
        yield say.extension_in_proto3(extension.extendee)
    target = declared.messages.get(extendee[1:])
    if target and flag(target.message.options, "message_set_wire_format") and not _is_item(extension, declared):
        yield say.message_set_item(field.name)


def _is_item(extension: DeclaredExtension, declared: Declarations) -> bool:
    """Whether an extension can stand in a MessageSet: an optional message can."""
    type_, entry = extension.field.type, extension.entry
    singular = not entry.repeated and entry.features.field_presence != "LEGACY_REQUIRED"
    prefixed = entry.features.message_encoding == "LENGTH_PREFIXED"
    return isinstance(type_, Name) and singular and prefixed and type_.text[1:] in declared.messages
