"""All declarations of a set of files by absolute name, once every name in them is absolute, with the features that hold for each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Literal, assert_never

from rosetta_jit.frameworks.protobuf.proto.features import DEFAULTS, Features, choose, choose_for_field
from rosetta_jit.frameworks.protobuf.proto.symbols import fields_of, join, package_of
from rosetta_jit.frameworks.protobuf.proto.tree import Enum, Extend, Field, File, MapType, Message, Name, Oneof, Version
from rosetta_jit.startup.dataclass import dataclass

Place = Literal["message", "oneof", "extension"]


@dataclass(frozen=True, slots=True)
class DeclaredMessage:
    """A message with its absolute name, the version of the language that it is written in, its features, and its fields by name."""

    full: str
    message: Message
    version: Version
    features: Features
    fields: Mapping[str, Field]


@dataclass(frozen=True, slots=True)
class DeclaredEnum:
    """The same for an enum, and the numbers of its values by name."""

    full: str
    enum: Enum
    version: Version
    features: Features
    numbers: Mapping[str, int]

    @property
    def closed(self) -> bool:
        """Whether fields hold no other numbers than the named ones."""
        return self.features.enum_type == "CLOSED"


@dataclass(frozen=True, slots=True)
class DeclaredField:
    """The same for a field, and what it belongs to."""

    field: Field
    version: Version
    features: Features
    place: Place

    @property
    def repeated(self) -> bool:
        """Whether it is a list or a map."""
        return self.field.label == "repeated" or isinstance(self.field.type, MapType)


@dataclass(frozen=True, slots=True)
class DeclaredExtension:
    """An extension, and the message that it extends (empty where that is unknown)."""

    full: str
    extendee: Name
    entry: DeclaredField

    @property
    def field(self) -> Field:
        return self.entry.field


@dataclass(frozen=True, slots=True)
class Declarations:
    """What a set of files declares."""

    files: tuple[File, ...]
    messages: Mapping[str, DeclaredMessage]
    enums: Mapping[str, DeclaredEnum]
    extensions: Mapping[str, DeclaredExtension]


@dataclass(frozen=True, slots=True)
class _Scope:
    """What stands at one place of a file, beside messages, and the features that hold there."""

    full: str
    enums: tuple[Enum, ...]
    extends: tuple[Extend, ...]
    version: Version
    features: Features


def declarations(files: Iterable[File]) -> Declarations:
    """Index the files by absolute names, without a leading dot."""
    files = tuple(files)
    messages = [entry for file in files for entry in _messages(file)]
    scopes = [
        *(_Scope(package_of(file), file.enums, file.extends, file.version, file_features(file)) for file in files),
        *(_Scope(entry.full, entry.message.enums, entry.message.extends, entry.version, entry.features) for entry in messages),
    ]
    enums = (_enum(scope, enum) for scope in scopes for enum in scope.enums)
    extensions = (_extension(scope, extend.extendee, field) for scope in scopes for extend in scope.extends for field in extend.fields)
    return Declarations(
        files,
        {entry.full: entry for entry in messages},
        {entry.full: entry for entry in enums},
        {entry.full: entry for entry in extensions},
    )


def file_features(file: File) -> Features:
    """The features that hold in a file."""
    return choose(DEFAULTS[file.version], file.options)


def fields_in(entry: DeclaredMessage) -> Iterator[DeclaredField]:
    """The fields of a message, those in oneofs included."""
    for member in entry.message.members:
        match member:
            case Field():
                yield field_in(entry, member)
            case Oneof():
                yield from cases_in(entry, member)
            case _:
                assert_never(member)


def field_in(entry: DeclaredMessage, field: Field) -> DeclaredField:
    """A field of a message, in no oneof."""
    return DeclaredField(field, entry.version, choose_for_field(entry.features, field), "message")


def cases_in(entry: DeclaredMessage, oneof: Oneof) -> Iterator[DeclaredField]:
    """The fields of a oneof of a message."""
    features = choose(entry.features, oneof.options)
    for field in oneof.fields:
        yield DeclaredField(field, entry.version, choose_for_field(features, field), "oneof")


def _messages(file: File) -> Iterator[DeclaredMessage]:
    """Every message of a file, outer ones first."""
    features = file_features(file)
    for message in file.messages:
        yield from _nested(package_of(file), message, file.version, features)


def _nested(scope: str, message: Message, version: Version, inherited: Features) -> Iterator[DeclaredMessage]:
    full, features = join(scope, message.name.text), choose(inherited, message.options)
    yield DeclaredMessage(full, message, version, features, {field.name.text: field for field in fields_of(message)})
    for inner in message.messages:
        yield from _nested(full, inner, version, features)


def _enum(scope: _Scope, enum: Enum) -> DeclaredEnum:
    features = choose(scope.features, enum.options)
    return DeclaredEnum(
        join(scope.full, enum.name.text), enum, scope.version, features, {value.name.text: value.number for value in enum.values}
    )


def _extension(scope: _Scope, extendee: Name, field: Field) -> DeclaredExtension:
    entry = DeclaredField(field, scope.version, choose_for_field(scope.features, field), "extension")
    return DeclaredExtension(join(scope.full, field.name.text), extendee, entry)
