"""Extensions: of a message that has a place for them, each with a number of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf.proto.check_numbers import containing, in_order
from rosetta_jit.frameworks.protobuf.proto.options import OPTIONS, flag
from rosetta_jit.frameworks.protobuf.proto.tree import MapType, Name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, DeclaredExtension

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
