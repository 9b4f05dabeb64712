"""FileDescriptorProto to `tree.File`: the same file as its text gives, without places and comments.

https://github.com/protocolbuffers/protobuf/blob/main/src/google/protobuf/descriptor.proto says what each field means.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.frameworks.protobuf.json_names import camel_case
from rosetta_jit.frameworks.protobuf.limits import MAX_NAME, MAX_SHOWN
from rosetta_jit.frameworks.protobuf.proto import tree
from rosetta_jit.frameworks.protobuf.proto.descriptor_features import (
    features,
    has_unknown_features,
    option_dependencies,
)
from rosetta_jit.frameworks.protobuf.proto.descriptor_options import Extensions, custom_options, extensions_in, own_options
from rosetta_jit.frameworks.protobuf.proto.literals import EscapeError, number, unescape
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from google.protobuf.descriptor_pb2 import (
        DescriptorProto,
        EnumDescriptorProto,
        FieldDescriptorProto,
        FileDescriptorProto,
        OneofDescriptorProto,
        ServiceDescriptorProto,
    )

    from rosetta_jit.frameworks.protobuf.proto.descriptor_features import Holder

TYPE_GROUP = 10
WORDS: Mapping[int, str] = {
    1: "double",
    2: "float",
    3: "int64",
    4: "uint64",
    5: "int32",
    6: "fixed64",
    7: "fixed32",
    8: "bool",
    9: "string",
    12: "bytes",
    13: "uint32",
    15: "sfixed32",
    16: "sfixed64",
    17: "sint32",
    18: "sint64",
}
"""FieldDescriptorProto.Type, where it is a scalar's."""
EDITION_NUMBERS: Mapping[int, tree.Edition] = {1000: "2023", 1001: "2024"}
"""google.protobuf.Edition"""
PATH = re.compile(r"\.?[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)*")
LABEL_REPEATED = 3
LABELS: Mapping[int, tree.Label] = {1: "optional", 2: "required", 3: "repeated"}


def read_files(files: Iterable[FileDescriptorProto], problems: list[Diagnostic]) -> list[tree.File]:
    """The files of a descriptor set; those of a version that is not known are problems."""
    files = list(files)
    extensions = extensions_in(files)
    return [_Reader(_version(file, problems), extensions, problems).file(file) for file in files]


def _version(file: FileDescriptorProto, problems: list[Diagnostic]) -> tree.Version:
    number = file.edition
    if file.syntax == "editions" and number in EDITION_NUMBERS:
        return EDITION_NUMBERS[number]
    for syntax in tree.SYNTAXES:
        if file.syntax == syntax or (not file.syntax and not number):
            return syntax
    # An edition that is newer than protobuf's Python package is an unknown field to it, and reads as 0.
    written = f"edition {number}" if number else "an unknown edition" if file.syntax == "editions" else file.syntax
    problems.append(of_file.unsupported_descriptor(file.name, written))
    return tree.EDITIONS[-1]


@dataclass(frozen=True, slots=True)
class _Reader:
    version: tree.Version
    extensions: Extensions
    problems: list[Diagnostic]

    def file(self, file: FileDescriptorProto) -> tree.File:
        return tree.File(
            name=self.text(file.name),
            version=self.version,
            package=self.name(file.package) if file.package else None,
            imports=tuple(self.imports(file)),
            messages=tuple(self.message(message) for message in file.message_type),
            enums=tuple(self.enum(enum) for enum in file.enum_type),
            extends=tuple(self.extend(field) for field in file.extension),
            services=tuple(self.service(service) for service in file.service),
            options=self.options("FileOptions", file.options),
        )

    def imports(self, file: FileDescriptorProto) -> Iterator[tree.Import]:
        public = frozenset(file.public_dependency)
        for index, path in enumerate(file.dependency):
            yield tree.Import(self.text(path), "public" if index in public else "plain")
        for path in option_dependencies(file):
            yield tree.Import(self.text(path), "option")

    def options(self, holder: str, options: Holder) -> tuple[tree.Option, ...]:
        if has_unknown_features(options):
            self.problems.append(of_file.bad_descriptor("a feature has a value that is not known"))
        return (*own_options(holder, options), *features(options))

    def message(self, message: DescriptorProto) -> tree.Message:
        entries = {inner.name: inner for inner in message.nested_type if _is_entry(inner)}
        return tree.Message(
            name=self.name(message.name),
            members=tuple(self.members(message, entries)),
            messages=tuple(self.message(inner) for inner in message.nested_type if not _is_entry(inner)),
            enums=tuple(self.enum(enum) for enum in message.enum_type),
            extends=tuple(self.extend(field) for field in message.extension),
            extensions=tuple(tree.Range(range_.start, range_.end - 1) for range_ in message.extension_range),
            reserved=tuple(tree.Range(range_.start, range_.end - 1) for range_ in message.reserved_range),
            reserved_names=tuple(tree.Name(self.text(name)) for name in message.reserved_name),
            options=self.options("MessageOptions", message.options),
        )

    def members(self, message: DescriptorProto, entries: Mapping[str, DescriptorProto]) -> list[tree.Field | tree.Oneof]:
        """Fields in order; those of a oneof together, where its first one stands."""
        # A proto3 `optional` field stands in a oneof of its own, which exists for old readers alone.
        synthetic = {field.oneof_index for field in message.field if field.proto3_optional}
        cases: dict[int, list[tree.Field]] = {index: [] for index in range(len(message.oneof_decl)) if index not in synthetic}
        order: list[tree.Field | int] = []
        for field in message.field:
            read = self.field(field, entries)
            if not field.HasField("oneof_index") or field.oneof_index not in cases:
                order.append(read)
                continue
            if not cases[field.oneof_index]:
                order.append(field.oneof_index)
            cases[field.oneof_index].append(read)
        order += [index for index, fields in cases.items() if not fields]
        return [item if isinstance(item, tree.Field) else self.oneof(message.oneof_decl[item], cases[item]) for item in order]

    def oneof(self, oneof: OneofDescriptorProto, fields: list[tree.Field]) -> tree.Oneof:
        return tree.Oneof(self.name(oneof.name), tuple(fields), self.options("OneofOptions", oneof.options))

    def extend(self, field: FieldDescriptorProto) -> tree.Extend:
        return tree.Extend(self.name(field.extendee), (self.field(field, {}),))

    def field(self, field: FieldDescriptorProto, entries: Mapping[str, DescriptorProto]) -> tree.Field:
        entry = entries.get(self.text(field.type_name).rpartition(".")[2]) if field.label == LABEL_REPEATED else None
        default = (tree.Option(("default",), self.default(field)),) if field.HasField("default_value") else ()
        in_json = self.text(field.json_name)
        chosen = in_json and in_json != camel_case(self.text(field.name)) and not field.extendee
        named = (tree.Option(("json_name",), in_json.encode()),) if chosen else ()
        return tree.Field(
            name=self.name(field.name),
            type=self.type(field) if entry is None else tree.MapType(self.type(entry.field[0]), self.type(entry.field[1])),
            number=field.number,
            label=None if entry else self.label(field),
            group=field.type == TYPE_GROUP,
            options=(
                *default,
                *named,
                *self.options("FieldOptions", field.options),
                *custom_options(field.options, self.extensions),
            ),
        )

    def label(self, field: FieldDescriptorProto) -> tree.Label | None:
        """The label that the text has: an implicit `optional` is none."""
        label = LABELS.get(field.label)
        if label != "optional" or field.proto3_optional:
            return label
        return None if self.version != "proto2" or field.HasField("oneof_index") else label

    def default(self, field: FieldDescriptorProto) -> tree.Value:
        """A default, which a descriptor holds as text whatever its type is."""
        text = self.text(field.default_value)
        match WORDS.get(field.type):
            case "string":
                return text.encode()
            case "bytes":
                try:
                    return unescape(text)
                except EscapeError:
                    self.problems.append(of_file.bad_descriptor(f"`{field.name}` has a default with a wrong escape"))
                    return b""
            case None | "bool":
                return tree.Word(text)
            case _:
                return _signed(text)

    def type(self, field: FieldDescriptorProto) -> tree.Name:
        word = WORDS.get(field.type)
        return self.name(field.type_name) if word is None else tree.Name(word)

    def enum(self, enum: EnumDescriptorProto) -> tree.Enum:
        return tree.Enum(
            name=self.name(enum.name),
            values=tuple(tree.EnumValue(self.name(value.name), value.number) for value in enum.value),
            reserved=tuple(tree.Range(range_.start, range_.end) for range_ in enum.reserved_range),
            reserved_names=tuple(tree.Name(self.text(name)) for name in enum.reserved_name),
            options=self.options("EnumOptions", enum.options),
        )

    def service(self, service: ServiceDescriptorProto) -> tree.Service:
        methods = (
            tree.Method(self.name(method.name), (self.name(method.input_type), self.name(method.output_type))) for method in service.method
        )
        return tree.Service(self.name(service.name), tuple(methods))

    def name(self, text: str | bytes) -> tree.Name:
        """A name or a path; whoever made the descriptor may have put anything there."""
        if isinstance(text, str) and len(text) <= MAX_NAME and PATH.fullmatch(text):
            return tree.Name(text)
        self.problems.append(of_file.bad_descriptor(f"{text[:MAX_SHOWN]!r} is no name"))
        return tree.Name("wrong")

    def text(self, text: str | bytes) -> str:
        """A string; where it is not UTF-8, protobuf gives bytes in spite of its annotations."""
        if isinstance(text, str):
            return text
        self.problems.append(of_file.bad_descriptor(f"{text[:MAX_SHOWN]!r} is no text"))
        return ""


def _signed(text: str) -> tree.Value:
    value = number(text.removeprefix("-"))
    if value is None:
        return tree.Word(text)
    return -value if text.startswith("-") else value


def _is_entry(message: DescriptorProto) -> bool:
    """Whether a message stands for the entries of a map."""
    return message.options.map_entry and len(message.field) == 2
