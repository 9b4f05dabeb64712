"""The definition of a message as a serialised `FileDescriptorSet`, as logs carry it.

Each file keeps its types, but is written in the simplest form that says of each field what the decoder knows: proto3 where presence is
implicit, proto2 where it is tracked, and edition 2023 where a file has both. Extensions are left out: readers keep them as unknown fields.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from rosetta_jit.frameworks.definitions import Definition, declared
from rosetta_jit.frameworks.protobuf.introspection import OPTIONAL, TYPES, FieldDescriptor, MessageDescriptor
from rosetta_jit.model.types import Declaration, Enum, Map, Optional, Schema, Struct
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from google.protobuf.descriptor_pb2 import DescriptorProto, EnumDescriptorProto, FieldDescriptorProto, FileDescriptorProto

    Syntax: TypeAlias = Literal["proto2", "proto3", "editions"]

EDITION_2023 = 1000


def definition(struct: Struct, schema: Schema) -> Definition:
    """The descriptors of a message and of all types that it needs, by files, those that others import first."""
    from google.protobuf.descriptor_pb2 import FileDescriptorSet

    types = declared(struct, schema)
    files: dict[str, list[str]] = {}
    for name in types:
        files.setdefault(_file_of(_outermost(name, schema), schema), []).append(name)
    found = FileDescriptorSet()
    for file in _imported_first(files, types, schema):
        names = {_outermost(name, schema) for name in files[file]}
        found.file.append(_File(file, schema).written(sorted(names), files, types))
    return Definition("protobuf", found.SerializeToString(deterministic=True))


def _outermost(name: str, schema: Schema) -> str:
    """The type around a type, which a file declares."""
    parent = name.rpartition(".")[0]
    return _outermost(parent, schema) if parent in schema.types else name


def _file_of(name: str, schema: Schema) -> str:
    """The name of the file of a type: its package's folder, and what the file is called if that is known."""
    package, span = name.rpartition(".")[0], schema.types[name].span
    stem = "types" if span is None else span.source.name.replace("\\", "/").rpartition("/")[2].removesuffix(".proto") or "types"
    return "/".join([*package.split("."), f"{stem}.proto"]) if package else f"{stem}.proto"


def _needs(name: str, types: dict[str, Declaration], schema: Schema) -> set[str]:
    """The types that the fields of a type are of."""
    type_ = types[name]
    if not isinstance(type_, Struct):
        return set()
    found: set[str] = set()
    for each in MessageDescriptor(type_, schema).fields:
        if each.is_extension:
            continue
        inner = each.message_type.fields if isinstance(each.field.type, Map) and each.message_type else [each]
        found |= {of.full_name for one in inner for of in (one.message_type, one.enum_type) if of is not None}
    return found


def _imported_first(files: dict[str, list[str]], types: dict[str, Declaration], schema: Schema) -> list[str]:
    imports = {file: set(_imports(file, files, types, schema)) for file in files}
    done: list[str] = []
    while imports:
        ready = [file for file, needed in imports.items() if needed.isdisjoint(imports)] or [next(iter(imports))]
        done += ready
        for file in ready:
            del imports[file]
    return done


def _imports(file: str, files: dict[str, list[str]], types: dict[str, Declaration], schema: Schema) -> list[str]:
    needed = {each for name in files[file] for each in _needs(name, types, schema)}
    return sorted({_file_of(_outermost(each, schema), schema) for each in needed} - {file})


@dataclass(slots=True)
class _File:
    """A file that is being written."""

    name: str
    schema: Schema
    syntax: Syntax = "proto2"

    def written(self, outer: list[str], files: dict[str, list[str]], types: dict[str, Declaration]) -> FileDescriptorProto:
        from google.protobuf.descriptor_pb2 import FileDescriptorProto

        structs = [each for name in files[self.name] if isinstance(each := types[name], Struct)]
        enums = [each for name in files[self.name] if isinstance(each := types[name], Enum)]
        self.syntax = _syntax([field for each in structs for field in MessageDescriptor(each, self.schema).fields], enums)
        file = FileDescriptorProto(name=self.name, package=outer[0].rpartition(".")[0], syntax=self.syntax)
        if self.syntax == "editions":
            file.edition = EDITION_2023  # pyright: ignore[reportAttributeAccessIssue] - an enum's number
        file.dependency.extend(_imports(self.name, files, types, self.schema))
        for name in outer:
            self._declare(self.schema.types[name], file.message_type, file.enum_type)
        return file

    def _declare(self, type_: Declaration, messages: Any, enums: Any) -> None:
        match type_:
            case Struct():
                self._message(type_, messages.add())
            case Enum():
                self._enum(type_, enums.add())

    def _message(self, struct: Struct, to: DescriptorProto) -> None:
        message = MessageDescriptor(struct, self.schema)
        to.name = message.name
        for oneof in message.oneofs:
            to.oneof_decl.add(name=oneof.name)
        for each in message.fields:
            if not each.is_extension:
                self._field(each, to)
        for name in sorted(name for name in self.schema.types if name.rpartition(".")[0] == struct.name):
            self._declare(self.schema.types[name], to.nested_type, to.enum_type)

    def _field(self, of: FieldDescriptor, message: DescriptorProto) -> None:
        field = message.field.add(name=of.name, number=of.number, label=of.label, type=of.type)
        if isinstance(of.field.type, Map):
            self._map(of, field, message)
            return
        if of.field.option("json_name"):
            field.json_name = of.json_name
        self._type(of, field)
        if of.containing_oneof is not None:
            field.oneof_index = [each.name for each in message.oneof_decl].index(of.containing_oneof.name)
        if of.field.default is not None:
            field.default_value = _default(of)
        self._features(of, field, message)

    def _type(self, of: FieldDescriptor, field: FieldDescriptorProto) -> None:
        inner = of.message_type or of.enum_type
        if inner is not None:
            field.type_name = f".{inner.full_name}"

    def _map(self, of: FieldDescriptor, field: FieldDescriptorProto, message: DescriptorProto) -> None:
        """A map is a list of entries, whose type is declared beside it."""
        assert of.message_type is not None
        field.type_name = f".{of.message_type.full_name}"
        entry = message.nested_type.add(name=of.message_type.name)
        entry.options.map_entry = True
        for each in of.message_type.fields:
            part = entry.field.add(name=each.name, number=each.number, label=OPTIONAL, type=each.type)
            self._type(each, part)

    def _features(self, of: FieldDescriptor, field: FieldDescriptorProto, message: DescriptorProto) -> None:
        packed, features = of.field.option("packed"), field.options.features
        match self.syntax:
            case "proto3":
                if of.has_presence and of.containing_oneof is None and of.message_type is None:
                    field.proto3_optional = True
                    field.oneof_index = len(message.oneof_decl)
                    message.oneof_decl.add(name=f"_{of.name}")
                if packed is False:
                    field.options.packed = False
            case "proto2":
                if packed:
                    field.options.packed = True
            case "editions":
                field.label = field.LABEL_REPEATED if of.is_repeated else field.LABEL_OPTIONAL
                if of.type == TYPES["group"]:
                    field.type = field.TYPE_MESSAGE
                    features.message_encoding = features.DELIMITED
                if packed is False:
                    features.repeated_field_encoding = features.EXPANDED
                if of.is_required:
                    features.field_presence = features.LEGACY_REQUIRED
                elif _is_implicit(of):
                    features.field_presence = features.IMPLICIT
        if not field.options.ByteSize():
            field.ClearField("options")

    def _enum(self, enum: Enum, to: EnumDescriptorProto) -> None:
        to.name = enum.name.rpartition(".")[2]
        for name, number in enum.values:
            to.value.add(name=name, number=number)
        if len({number for _, number in enum.values}) < len(enum.values):
            to.options.allow_alias = True
        if self.syntax == "editions" and enum.closed:
            to.options.features.enum_type = to.options.features.CLOSED


def _is_implicit(of: FieldDescriptor) -> bool:
    """Whether a field that is absent has the value zero."""
    return not of.is_repeated and of.containing_oneof is None and not isinstance(of.field.type, Optional)


def _syntax(fields: list[FieldDescriptor], enums: list[Enum]) -> Syntax:
    implicit = any(_is_implicit(each) for each in fields)
    open_ = any(not each.closed for each in enums)
    old = any(each.is_required or each.field.default is not None or each.type == TYPES["group"] for each in fields)
    old = old or any(each.closed for each in enums)
    if not old and (implicit or open_):
        return "proto3"
    return "editions" if implicit or open_ else "proto2"


def _default(of: FieldDescriptor) -> str:
    """A default as a descriptor has it: a text."""
    value = of.field.default
    match value:
        case bool():
            return "true" if value else "false"
        case bytes():
            return "".join(chr(byte) if 32 <= byte < 127 and byte not in b"\\\"'" else f"\\{byte:03o}" for byte in value)
        case int() if of.enum_type is not None:
            return of.enum_type.values_by_number[value].name
        case float():
            return {"inf": "inf", "-inf": "-inf", "nan": "nan"}.get(repr(value), repr(value))
        case _:
            return str(value)
