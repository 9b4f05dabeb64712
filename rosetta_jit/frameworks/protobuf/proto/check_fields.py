"""Labels, groups, maps, oneofs, defaults and `packed`: what a field may be in its version of the language."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import proto as say
from rosetta_jit.frameworks.protobuf.proto.constants import WrongValueError, constant, enum_number, spelled
from rosetta_jit.frameworks.protobuf.proto.options import flag
from rosetta_jit.frameworks.protobuf.proto.scalars import SCALARS, is_packable
from rosetta_jit.frameworks.protobuf.proto.symbols import fields_of
from rosetta_jit.frameworks.protobuf.proto.tree import Field, MapType, Name, Oneof

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, DeclaredMessage
    from rosetta_jit.frameworks.protobuf.proto.tree import Option, Version

NO_KEYS = frozenset(("double", "float", "bytes"))
"""Scalars that a map cannot have as keys."""


def check_fields(declared: Declarations) -> Iterator[Diagnostic]:
    """The fields of each message, and all extensions."""
    for entry in declared.messages.values():
        yield from _message(entry, declared)
    for extension in declared.extensions.values():
        yield from _label(extension.field, extension.version)
        yield from _field(extension.field, extension.version, declared)


def json_name(field: Field) -> str:
    """The name of a field in JSON where it chooses none: `frame_shift` is `frameShift`."""
    first, *rest = field.name.text.split("_")
    return first + "".join(part[:1].upper() + part[1:] for part in rest)


def _message(entry: DeclaredMessage, declared: Declarations) -> Iterator[Diagnostic]:
    if entry.version == "proto3" and entry.message.extensions:
        yield say.extensions_in_proto3(entry.message.extensions[0].span)
    for member in entry.message.members:
        match member:
            case Oneof():
                yield from _oneof(member)
            case Field():
                yield from _label(member, entry.version)
    for field in fields_of(entry.message):
        yield from _field(field, entry.version, declared)
    yield from _json_names(entry)


def _oneof(oneof: Oneof) -> Iterator[Diagnostic]:
    if not oneof.fields:
        yield say.empty_oneof(oneof.name)
    for field in oneof.fields:
        if isinstance(field.type, MapType):
            yield say.map_in_oneof(field.type.span)
        elif field.label:
            yield say.label_in_oneof(field.label_span, field.label)


def _label(field: Field, version: Version) -> Iterator[Diagnostic]:
    match field.type, field.label, version:
        case (MapType(), None, _) | (_, "optional" | "repeated", "proto3"):
            pass
        case MapType(), str(), _:
            yield say.label_on_map(field.label_span)
        case _, None, "proto2":
            yield say.missing_label(field.name)
        case _, "required", "proto3":
            yield say.required_in_proto3(field.label_span)
        case _:
            pass


def _field(field: Field, version: Version, declared: Declarations) -> Iterator[Diagnostic]:
    if isinstance(field.type, MapType):
        yield from _map(field.type)
        enum = declared.enums.get(field.type.value.text[1:])
    else:
        enum = declared.enums.get(field.type.text[1:])
    if field.group and isinstance(field.type, Name) and field.type.text and field.type.text[1:] not in declared.messages:
        yield say.bad_descriptor(f"the group `{field.name.text}` has no message")
    if field.group and version == "proto3":
        yield say.group_in_proto3(field.name)
    if enum and isinstance(field.type, MapType) and enum.enum.values and enum.enum.values[0].number != 0:
        yield say.map_enum(field.type.value, enum.full)
    if enum and enum.version == "proto2" and version == "proto3":
        yield say.closed_enum(field.name, enum.full)
    for option in field.options:
        if option.parts == ("default",):
            yield from _default(field, version, option, declared)
    if flag(field.options, "packed") and not _can_pack(field, declared):
        yield say.cannot_pack(field.name)


def _map(type_: MapType) -> Iterator[Diagnostic]:
    if type_.key.text and (type_.key.text not in SCALARS or type_.key.text in NO_KEYS):
        yield say.map_key(type_.key)


def _default(field: Field, version: Version, option: Option, declared: Declarations) -> Iterator[Diagnostic]:
    if version == "proto3":
        yield say.default_in_proto3(option.span)
    elif isinstance(field.type, MapType) or field.label == "repeated":
        yield say.default_of_many(option.span)
    elif field.type.text:
        yield from _default_value(field.type, option, declared)


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


def _json_names(entry: DeclaredMessage) -> Iterator[Diagnostic]:
    """In proto3 two fields must not have the same name in JSON."""
    if entry.version == "proto2" or flag(entry.message.options, "deprecated_legacy_json_field_conflicts"):
        return
    seen: dict[str, Field] = {}
    for field in fields_of(entry.message):
        first = seen.setdefault(json_name(field), field)
        if first is not field and first.name.text != field.name.text:
            yield say.same_json_name(field.name, first.name, json_name(field))
