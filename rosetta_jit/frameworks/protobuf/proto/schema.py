"""Declarations to the meta-model.

message → Struct, enum → Enum, oneof → one field with a Union. A singular field whose presence is tracked is Optional, also
where it is `required`; in proto3 a scalar without `optional` is not tracked and stays plain. An extension is a field of the
message that it extends, named `[package.extension]`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.frameworks.protobuf.proto.constants import constant, enum_number
from rosetta_jit.frameworks.protobuf.proto.options import field_options, flag
from rosetta_jit.frameworks.protobuf.proto.scalars import SCALARS, is_packable
from rosetta_jit.frameworks.protobuf.proto.symbols import join
from rosetta_jit.frameworks.protobuf.proto.tree import Field, MapType, Name, Oneof
from rosetta_jit.model import types as model

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosetta_jit.frameworks.protobuf.proto.declarations import (
        Declarations,
        DeclaredEnum,
        DeclaredExtension,
        DeclaredMessage,
    )
    from rosetta_jit.frameworks.protobuf.proto.tree import Version
    from rosetta_jit.model.types import Constant, Schema


def build(declared: Declarations) -> Schema:
    """The schema of declarations that have been checked."""
    builder = _Builder(declared, _by_extendee(declared))
    types: dict[str, model.Declaration] = {full: builder.struct(entry) for full, entry in declared.messages.items()}
    types |= {full: enum(entry) for full, entry in declared.enums.items()}
    return model.Schema(types, tuple(file.name for file in declared.files))


def enum(entry: DeclaredEnum) -> model.Enum:
    """An enum; those of proto2 hold no other numbers than the named ones."""
    values = tuple((value.name.text, value.number) for value in entry.enum.values)
    return model.Enum(entry.full, values, closed=entry.version == "proto2", span=entry.enum.name.span)


KEEPS_UNKNOWN = (("unknown", True),)
"""The option of a struct whose messages keep fields that the schema does not know."""


@dataclass(frozen=True, slots=True)
class _Builder:
    declared: Declarations
    extensions: Mapping[str, tuple[DeclaredExtension, ...]]

    def struct(self, entry: DeclaredMessage) -> model.Struct:
        message = entry.message
        own = tuple(self.member(entry, member) for member in message.members)
        added = tuple(self.extension(extension) for extension in self.extensions.get(entry.full, ()))
        return model.Struct(entry.full, own + added, doc=message.doc, span=message.name.span, options=KEEPS_UNKNOWN)

    def member(self, entry: DeclaredMessage, member: Field | Oneof) -> model.Field:
        match member:
            case Field():
                return self.field(member.name.text, member, self.labelled(member, entry.version), entry.version)
            case Oneof(name):
                full = join(entry.full, name.text)
                cases = tuple(self.field(field.name.text, field, self.value(field), entry.version) for field in member.fields)
                union = model.Union(full, cases, span=name.span)
                return model.Field(name.text, union, doc=member.doc, span=name.span)
            case _:
                assert_never(member)

    def extension(self, extension: DeclaredExtension) -> model.Field:
        field = extension.field
        # An extension is tracked in proto3 too: there is no implicit presence outside of a message's own fields.
        type_ = self.labelled(field, "proto2")
        return self.field(f"[{extension.full}]", field, type_, extension.version, ("extension", True))

    def field(self, name: str, field: Field, type_: model.Type, version: Version, *marks: tuple[str, Constant]) -> model.Field:
        return model.Field(
            name=name,
            type=type_,
            number=field.number,
            default=self.default(field),
            required=field.label == "required",
            options=tuple(sorted((*marks, *self.encoding(field, version), *field_options(field, self.declared)))),
            doc=field.doc,
            span=field.name.span,
        )

    def labelled(self, field: Field, version: Version) -> model.Type:
        value = self.value(field)
        if field.label == "repeated":
            return model.Array(value)
        if isinstance(value, model.Map):
            return value
        is_message = isinstance(field.type, Name) and field.type.text[1:] in self.declared.messages
        tracked = version == "proto2" or field.label == "optional" or is_message
        return model.Optional(value) if tracked else value

    def value(self, field: Field) -> model.Type:
        """The type of one value of a field."""
        match field.type:
            case MapType(key, value):
                return model.Map(self.named(key), self.named(value))
            case Name():
                return self.named(field.type)
            case _:
                assert_never(field.type)

    def named(self, name: Name) -> model.Type:
        return SCALARS[name.text] if name.text in SCALARS else model.Ref(name.text[1:], span=name.span)

    def default(self, field: Field) -> Constant | None:
        for option in field.options:
            if option.parts == ("default",) and isinstance(field.type, Name):
                word = field.type.text
                if word in SCALARS:
                    return constant(SCALARS[word], option.value)
                return enum_number(self.declared.enums[word[1:]].numbers, option.value)
        return None

    def encoding(self, field: Field, version: Version) -> list[tuple[str, Constant]]:
        """What the wire must know of a field beside its type."""
        if field.group:
            return [("group", True)]
        if isinstance(field.type, MapType) or field.label != "repeated":
            return []
        word = field.type.text
        if not (word[1:] in self.declared.enums or (word in SCALARS and is_packable(word))):
            return []
        packed = flag(field.options, "packed")
        return [("packed", version == "proto3" if packed is None else packed)]


def _by_extendee(declared: Declarations) -> dict[str, tuple[DeclaredExtension, ...]]:
    """The extensions of each message, by their numbers."""
    found: dict[str, list[DeclaredExtension]] = {}
    for extension in declared.extensions.values():
        found.setdefault(extension.extendee.text[1:], []).append(extension)
    return {full: tuple(sorted(some, key=lambda entry: entry.field.number)) for full, some in found.items()}
