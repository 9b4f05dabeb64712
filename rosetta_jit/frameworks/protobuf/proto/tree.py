r"""What a `.proto` file says, before any name is looked up.

    File    = version, package, Import*, Message*, Enum*, Extend*, Service*, Option*
    Message = name, (Field | Oneof)*, Message*, Enum*, Extend*, Range*, reserved names, Option*
    Field   = name, label, (Name | MapType), number, Option*

A group is a field (`group` is set) and a message beside it. Spans are None where the file came as a descriptor.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, get_args

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.source import Span

Syntax = Literal["proto2", "proto3"]
Edition = Literal["2023", "2024"]
Version = Syntax | Edition
SYNTAXES: tuple[Syntax, ...] = get_args(Syntax)
EDITIONS: tuple[Edition, ...] = get_args(Edition)
Label = Literal["optional", "required", "repeated"]
ImportKind = Literal["plain", "public", "weak", "option"]


@dataclass(frozen=True, slots=True)
class Name:
    """A name as it was written: a simple one, a path, or a path with a leading dot."""

    text: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Word:
    """A word where a value is wanted: `true`, `-inf`, a value of an enum."""

    text: str


@dataclass(frozen=True, slots=True)
class Listing:
    """`[1, 2]` in a message in text format."""

    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Entry:
    """`name: value` in a message in text format. The name of an extension is in parentheses, as in an option's name."""

    name: str
    value: Value


@dataclass(frozen=True, slots=True)
class Aggregate:
    """A message in text format: `{ name: value ... }`."""

    entries: tuple[Entry, ...] = ()


Value = int | float | bytes | Word | Aggregate | Listing


@dataclass(frozen=True, slots=True)
class Option:
    """`name = value`. A part of the name in parentheses is the name of an extension: `(my.option).size`."""

    parts: tuple[str, ...]
    value: Value
    span: Span | None = None

    @property
    def name(self) -> str:
        """The name of the option as it was written."""
        return ".".join(self.parts)


LARGEST_FIELD_NUMBER = 2**29 - 1
LARGEST_ENUM_NUMBER = 2**31 - 1
LARGEST_MESSAGE_SET_NUMBER = 2**31 - 2
"""`max` in an extension range of a message with `message_set_wire_format`."""


@dataclass(frozen=True, slots=True)
class Range:
    """Numbers `first` to `last`, both included."""

    first: int
    last: int
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class MapType:
    """`map<key, value>`."""

    key: Name
    value: Name
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Field:
    """A field, a case of a oneof or an extension; `optional` in proto3 is a label like the others."""

    name: Name
    type: Name | MapType
    number: int
    number_span: Span | None = None
    label: Label | None = None
    label_span: Span | None = None
    group: bool = False
    options: tuple[Option, ...] = ()
    doc: str = ""
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Oneof:
    """Fields of which at most one is set."""

    name: Name
    fields: tuple[Field, ...]
    options: tuple[Option, ...] = ()
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Extend:
    """Fields that are added to a message declared elsewhere."""

    extendee: Name
    fields: tuple[Field, ...]


@dataclass(frozen=True, slots=True)
class EnumValue:
    """One named number."""

    name: Name
    number: int
    number_span: Span | None = None
    options: tuple[Option, ...] = ()


@dataclass(frozen=True, slots=True)
class Enum:
    """Named numbers, and those that must not be used."""

    name: Name
    values: tuple[EnumValue, ...]
    reserved: tuple[Range, ...] = ()
    reserved_names: tuple[Name, ...] = ()
    options: tuple[Option, ...] = ()


@dataclass(frozen=True, slots=True)
class Message:
    """Fields in order, and what is declared inside."""

    name: Name
    members: tuple[Field | Oneof, ...] = ()
    messages: tuple[Message, ...] = ()
    enums: tuple[Enum, ...] = ()
    extends: tuple[Extend, ...] = ()
    extensions: tuple[Range, ...] = ()
    extension_options: tuple[Option, ...] = ()
    reserved: tuple[Range, ...] = ()
    reserved_names: tuple[Name, ...] = ()
    options: tuple[Option, ...] = ()
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Method:
    """A remote procedure; its types are looked up, and that is all."""

    name: Name
    types: tuple[Name, ...]
    options: tuple[Option, ...] = ()


@dataclass(frozen=True, slots=True)
class Service:
    """Remote procedures: no data, but names that others must not use."""

    name: Name
    methods: tuple[Method, ...]
    options: tuple[Option, ...] = ()


@dataclass(frozen=True, slots=True)
class Import:
    """Another file whose names can be used: in options alone, by whoever imports this file too, or neither."""

    path: str
    kind: ImportKind = "plain"
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class File:
    """One file."""

    name: str
    version: Version
    package: Name | None = None
    imports: tuple[Import, ...] = ()
    messages: tuple[Message, ...] = ()
    enums: tuple[Enum, ...] = ()
    extends: tuple[Extend, ...] = ()
    services: tuple[Service, ...] = ()
    options: tuple[Option, ...] = ()
