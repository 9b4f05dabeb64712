"""All declarations of a set of files by absolute name, once every name in them is absolute."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf.proto.symbols import enums_of, extends_of, join, messages_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rosetta_jit.frameworks.protobuf.proto.tree import Enum, Field, File, Message, Name, Version


@dataclass(frozen=True, slots=True)
class DeclaredMessage:
    """A message with its absolute name and the version of the language that it is written in."""

    full: str
    message: Message
    version: Version


@dataclass(frozen=True, slots=True)
class DeclaredEnum:
    """The same for an enum, and the numbers of its values by name."""

    full: str
    enum: Enum
    version: Version
    numbers: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class DeclaredExtension:
    """An extension, and the message that it extends (empty where that is unknown)."""

    full: str
    extendee: Name
    field: Field
    version: Version


@dataclass(frozen=True, slots=True)
class Declarations:
    """What a set of files declares."""

    files: tuple[File, ...]
    messages: Mapping[str, DeclaredMessage]
    enums: Mapping[str, DeclaredEnum]
    extensions: Mapping[str, DeclaredExtension]


def declarations(files: Iterable[File]) -> Declarations:
    """Index the files by absolute names, without a leading dot."""
    files = tuple(files)
    messages = (DeclaredMessage(full, message, file.version) for file in files for full, message in messages_of(file))
    enums = (_enum(full, enum, file.version) for file in files for full, enum in enums_of(file))
    extensions = (
        DeclaredExtension(join(scope, field.name.text), extend.extendee, field, file.version)
        for file in files
        for scope, extend in extends_of(file)
        for field in extend.fields
    )
    return Declarations(
        files,
        {entry.full: entry for entry in messages},
        {entry.full: entry for entry in enums},
        {entry.full: entry for entry in extensions},
    )


def _enum(full: str, enum: Enum, version: Version) -> DeclaredEnum:
    return DeclaredEnum(full, enum, version, {value.name.text: value.number for value in enum.values})
