"""Declarations to the meta-model.

message → Struct, enum → Enum, oneof → one field with a Union. A singular field whose presence is tracked is Optional, also
where it is required; a scalar whose presence is implicit stays plain. An extension is a field of the message that it extends,
named `[package.extension]`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from rosetta_jit.frameworks.protobuf.proto.check_json import chosen_names, default_name
from rosetta_jit.frameworks.protobuf.proto.constants import constant, enum_number
from rosetta_jit.frameworks.protobuf.proto.declarations import (
    Declarations,
    DeclaredEnum,
    DeclaredExtension,
    DeclaredField,
    DeclaredMessage,
    cases_in,
    field_in,
)
from rosetta_jit.frameworks.protobuf.proto.options import field_options
from rosetta_jit.frameworks.protobuf.proto.scalars import SCALARS, is_packable
from rosetta_jit.frameworks.protobuf.proto.symbols import join
from rosetta_jit.frameworks.protobuf.proto.tree import Field, MapType, Name, Oneof
from rosetta_jit.model import types as model
from rosetta_jit.model.types import Constant, Schema
from rosetta_jit.model.units import with_unit
from rosetta_jit.startup.dataclass import dataclass


def build(declared: Declarations) -> Schema:
    """The schema of declarations that have been checked."""
    builder = _Builder(declared, _by_extendee(declared))
    types: dict[str, model.Declaration] = {full: builder.struct(entry) for full, entry in declared.messages.items()}
    types |= {full: enum(entry) for full, entry in declared.enums.items()}
    return model.Schema(types, tuple(file.name for file in declared.files))


def enum(entry: DeclaredEnum) -> model.Enum:
    """An enum; a closed one holds no other numbers than the named ones."""
    values = tuple((value.name.text, value.number) for value in entry.enum.values)
    return model.Enum(entry.full, values, closed=entry.closed, span=entry.enum.name.span)


UNIT = "option.(rosetta_jit.unit)"
"""What says in which unit the values of a field are: idl/rosetta_jit/unit.proto."""

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
        options = (*self.nested(entry.full), *KEEPS_UNKNOWN)
        return model.Struct(entry.full, own + added, doc=message.doc, span=message.name.span, options=options)

    def nested(self, full: str) -> tuple[tuple[str, Constant], ...]:
        """How many messages a message is declared in, if in any: the names before theirs are the package's, however they are written."""
        outer = full.split(".")[:-1]
        depth = sum(".".join(outer[:end]) in self.declared.messages for end in range(1, len(outer) + 1))
        return (("nested", depth),) if depth else ()

    def member(self, entry: DeclaredMessage, member: Field | Oneof) -> model.Field:
        match member:
            case Field():
                declared = field_in(entry, member)
                return self.field(member.name.text, declared, self.labelled(declared))
            case Oneof(name):
                full = join(entry.full, name.text)
                cases = tuple(self.field(case.field.name.text, case, self.value(case.field)) for case in cases_in(entry, member))
                union = model.Union(full, cases, span=name.span)
                return model.Field(name.text, union, doc=member.doc, span=name.span)
            case _:
                assert_never(member)

    def extension(self, extension: DeclaredExtension) -> model.Field:
        return self.field(f"[{extension.full}]", extension.entry, self.labelled(extension.entry), ("extension", True))

    def field(self, name: str, entry: DeclaredField, type_: model.Type, *marks: tuple[str, Constant]) -> model.Field:
        field = entry.field
        options = field_options(field, self.declared)
        made = model.Field(
            name=name,
            type=type_,
            number=field.number,
            default=self.default(field),
            required=isinstance(type_, model.Optional) and entry.features.field_presence == "LEGACY_REQUIRED",
            options=tuple(sorted((*marks, *self.encoding(entry), *json_name(field), *options))),
            doc=field.doc,
            span=field.name.span,
        )
        unit = dict(options).get(UNIT)
        return with_unit(made, unit) if isinstance(unit, str) else made

    def labelled(self, entry: DeclaredField) -> model.Type:
        value = self.value(entry.field)
        if entry.field.label == "repeated":
            return model.Array(value)
        if isinstance(value, model.Map):
            return value
        # There is no implicit presence of messages, nor outside of a message's own fields.
        implicit = entry.features.field_presence == "IMPLICIT" and entry.place == "message" and not self.is_message(entry.field)
        return value if implicit else model.Optional(value)

    def is_message(self, field: Field) -> bool:
        return isinstance(field.type, Name) and field.type.text[1:] in self.declared.messages

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

    def encoding(self, entry: DeclaredField) -> list[tuple[str, Constant]]:
        """What the wire must know of a field beside its type."""
        field, features = entry.field, entry.features
        if self.is_message(field):
            return [("group", True)] if features.message_encoding == "DELIMITED" else []
        if isinstance(field.type, MapType) or field.label != "repeated":
            return []
        word = field.type.text
        if word in SCALARS and not is_packable(word):
            return []
        return [("packed", features.repeated_field_encoding == "PACKED")]


def json_name(field: Field) -> list[tuple[str, Constant]]:
    """The name in JSON, where the field chooses another than it would have."""
    found: list[tuple[str, Constant]] = [("json_name", name) for name in chosen_names(field) if name != default_name(field)]
    return found[-1:]


def _by_extendee(declared: Declarations) -> dict[str, tuple[DeclaredExtension, ...]]:
    """The extensions of each message, by their numbers."""
    found: dict[str, list[DeclaredExtension]] = {}
    for extension in declared.extensions.values():
        found.setdefault(extension.extendee.text[1:], []).append(extension)
    return {full: tuple(sorted(some, key=lambda entry: entry.field.number)) for full, some in found.items()}
