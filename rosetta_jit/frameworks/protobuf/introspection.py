"""What `DESCRIPTOR` answers: the part of protobuf's descriptors that code written against message classes asks for.

Numbers and names are those of `google.protobuf.descriptor.FieldDescriptor`. Only types that the message reaches are known.
"""

from __future__ import annotations

from typing import Any, ClassVar

from rosetta_jit.frameworks.protobuf.json_names import camel_case
from rosetta_jit.model.layout import map_entry
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Schema, String, Struct, Type, Union
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.dataclass import dataclass, field

TYPES = {
    "double": 1,
    "float": 2,
    "int64": 3,
    "uint64": 4,
    "int32": 5,
    "fixed64": 6,
    "fixed32": 7,
    "bool": 8,
    "string": 9,
    "group": 10,
    "message": 11,
    "bytes": 12,
    "uint32": 13,
    "enum": 14,
    "sfixed32": 15,
    "sfixed64": 16,
    "sint32": 17,
    "sint64": 18,
}
"""Numbers of the types in a `FieldDescriptorProto`, by their words."""
OPTIONAL, REQUIRED, REPEATED = 1, 2, 3
CPP_TYPES = {
    **dict.fromkeys(("int32", "sint32", "sfixed32"), 1),
    **dict.fromkeys(("int64", "sint64", "sfixed64"), 2),
    **dict.fromkeys(("uint32", "fixed32"), 3),
    **dict.fromkeys(("uint64", "fixed64"), 4),
    "double": 5,
    "float": 6,
    "bool": 7,
    "enum": 8,
    "string": 9,
    "bytes": 9,
    "message": 10,
    "group": 10,
}
"""Numbers of the types that C++ has for them."""
_WORDS = {number: word for word, number in TYPES.items()}
WRAPPED = ("Double", "Float", "Int64", "UInt64", "Int32", "UInt32", "Bool", "String", "Bytes")
"""What messages of `google/protobuf/wrappers.proto` hold."""


class EnumDescriptor:
    """An enum: its names and numbers."""

    def __init__(self, full_name: str, values: tuple[EnumValueDescriptor, ...], *, is_closed: bool) -> None:
        self.full_name = full_name
        self.values = values
        self.is_closed = is_closed

    def __repr__(self) -> str:
        return f"<enum {self.full_name}>"

    @property
    def name(self) -> str:
        return self.full_name.rpartition(".")[2]

    @cached_property
    def values_by_name(self) -> dict[str, EnumValueDescriptor]:
        return {value.name: value for value in self.values}

    @cached_property
    def values_by_number(self) -> dict[int, EnumValueDescriptor]:
        """The first name of each number, where several are aliases."""
        return {value.number: value for value in reversed(self.values)}


@dataclass(frozen=True, slots=True)
class EnumValueDescriptor:
    """A name of an enum, and its number."""

    name: str
    index: int
    number: int


@dataclass(frozen=True, slots=True, eq=False)
class OneofDescriptor:
    """A oneof: which fields share it."""

    name: str
    full_name: str
    fields: list[FieldDescriptor] = field(default_factory=list["FieldDescriptor"], repr=False)


class FieldDescriptor:
    """A field of a message."""

    LABEL_OPTIONAL: ClassVar[int] = OPTIONAL
    LABEL_REQUIRED: ClassVar[int] = REQUIRED
    LABEL_REPEATED: ClassVar[int] = REPEATED

    def __init__(self, of: Field, index: int, message: MessageDescriptor, oneof: OneofDescriptor | None = None) -> None:
        self.field = of
        self.index = index
        self.containing_type = message
        self.containing_oneof = oneof
        self.name = of.name
        self.full_name = f"{message.full_name}.{of.name}"
        self.number = of.number or 0
        self.is_extension = bool(of.option("extension"))
        self.label = REPEATED if isinstance(of.type, Array | Map) else REQUIRED if of.required else OPTIONAL
        self.is_required = self.label == REQUIRED
        self.is_repeated = self.label == REPEATED
        self.has_presence = oneof is not None or isinstance(of.type, Optional)
        self.has_default_value = of.default is not None

    def __repr__(self) -> str:
        return f"<field {self.full_name} = {self.number}>"

    @cached_property
    def _element(self) -> Type:
        """The type of one value, references resolved."""
        type_ = self.field.type
        if isinstance(type_, Map):
            return Struct(f"{self.containing_type.full_name}.{_entry_name(self.name)}", _entry_fields(type_))
        inner = type_.element if isinstance(type_, Array) else type_.value if isinstance(type_, Optional) else type_
        return self.containing_type.schema.resolve(inner)

    @property
    def type(self) -> int:
        """The number of the type in a `FieldDescriptorProto`."""
        match self._element:
            case Struct():
                return TYPES["group" if self.field.option("group") else "message"]
            case Enum():
                return TYPES["enum"]
            case Bool(spelling) | Float(_, spelling) | Int(_, _, spelling) | String(_, spelling) | Bytes(spelling):
                return TYPES.get(spelling, 0)
            case _:
                return 0

    @property
    def cpp_type(self) -> int:
        """The number of the type that C++ has for it."""
        return CPP_TYPES.get(_WORDS.get(self.type, ""), 0)

    @property
    def json_name(self) -> str:
        """The name of the field in JSON, chosen or in camel case."""
        chosen = self.field.option("json_name")
        return chosen if isinstance(chosen, str) else camel_case(self.name)

    @cached_property
    def message_type(self) -> MessageDescriptor | None:
        """The type of a message or group, else None; of a map, its entry."""
        if not isinstance(self._element, Struct):
            return None
        return MessageDescriptor(self._element, self.containing_type.schema, is_entry=isinstance(self.field.type, Map))

    @cached_property
    def enum_type(self) -> EnumDescriptor | None:
        """The type of an enum, else None."""
        return enum_descriptor(self._element) if isinstance(self._element, Enum) else None

    @property
    def default_value(self) -> Any:
        """What reading gives while the field is absent."""
        if self.is_repeated:
            return []
        match self._element:
            case Struct():
                return None
            case Enum(_, values, closed) if self.field.default is None:
                return values[0][1] if closed and values else 0
            case Bool():
                return bool(self.field.default)
            case Float():
                return 0.0 if self.field.default is None else self.field.default
            case String():
                return self.field.default or ""
            case Bytes():
                return self.field.default or b""
            case _:
                return self.field.default or 0


@dataclass(frozen=True, slots=True)
class FileDescriptor:
    """The file of a message, as far as it is known: those of the wrappers are."""

    name: str


@dataclass(frozen=True, slots=True)
class MessageOptions:
    """Whether a message stands for the pairs of a map."""

    map_entry: bool


class MessageDescriptor:
    """A message: its fields, and the types declared in it."""

    is_extendable: ClassVar[bool] = False
    """Extensions that are known are fields."""

    def __init__(self, struct: Struct, schema: Schema, *, is_entry: bool = False) -> None:
        self.struct = struct
        self.schema = schema
        self.has_options = is_entry
        self.full_name = struct.name
        self.name = struct.name.rpartition(".")[2]

    def __repr__(self) -> str:
        return f"<message {self.full_name}>"

    @property
    def file(self) -> FileDescriptor:
        """The file that it is declared in."""
        is_wrapper = self.full_name in {f"google.protobuf.{each}Value" for each in WRAPPED}
        return FileDescriptor("google/protobuf/wrappers.proto" if is_wrapper else "")

    def GetOptions(self) -> MessageOptions:  # noqa: N802  as protobuf names it
        """What the file says of the message besides."""
        return MessageOptions(self.has_options)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, MessageDescriptor) and other.struct == self.struct

    def __hash__(self) -> int:
        return hash(self.full_name)

    @cached_property
    def oneofs(self) -> list[OneofDescriptor]:
        """The oneofs, in order."""
        unions = [each for each in self.struct.fields if isinstance(each.type, Union)]
        return [OneofDescriptor(each.name, f"{self.full_name}.{each.name}") for each in unions]

    @cached_property
    def oneofs_by_name(self) -> dict[str, OneofDescriptor]:
        return {oneof.name: oneof for oneof in self.oneofs}

    @cached_property
    def fields(self) -> list[FieldDescriptor]:
        """All fields, those of oneofs included, in the order of the file."""
        fields: list[FieldDescriptor] = []
        for each in self.struct.fields:
            if isinstance(each.type, Union):
                oneof = self.oneofs_by_name[each.name]
                cases = [FieldDescriptor(case, len(fields) + index, self, oneof) for index, case in enumerate(each.type.cases)]
                oneof.fields.extend(cases)
                fields += cases
            else:
                fields.append(FieldDescriptor(each, len(fields), self))
        return fields

    @cached_property
    def fields_by_name(self) -> dict[str, FieldDescriptor]:
        return {each.name: each for each in self.fields}

    @cached_property
    def fields_by_number(self) -> dict[int, FieldDescriptor]:
        return {each.number: each for each in self.fields}

    @cached_property
    def nested_types(self) -> list[MessageDescriptor]:
        """Messages declared in this one."""
        inner = [self.schema.types[name] for name in nested_names(self.full_name, self.schema)]
        return [MessageDescriptor(each, self.schema) for each in inner if isinstance(each, Struct)]

    @cached_property
    def nested_types_by_name(self) -> dict[str, MessageDescriptor]:
        return {each.name: each for each in self.nested_types}

    @cached_property
    def enum_types(self) -> list[EnumDescriptor]:
        """Enums declared in this message."""
        inner = [self.schema.types[name] for name in nested_names(self.full_name, self.schema)]
        return [enum_descriptor(each) for each in inner if isinstance(each, Enum)]

    @cached_property
    def enum_types_by_name(self) -> dict[str, EnumDescriptor]:
        return {each.name: each for each in self.enum_types}


def nested_names(full_name: str, schema: Schema) -> list[str]:
    """Names of the types that are declared in a message."""
    return sorted(name for name in schema.types if name.rpartition(".")[0] == full_name)


def enum_descriptor(enum: Enum) -> EnumDescriptor:
    """The descriptor of an enum."""
    values = tuple(EnumValueDescriptor(name, index, number) for index, (name, number) in enumerate(enum.values))
    return EnumDescriptor(enum.name, values, is_closed=enum.closed)


def _entry_name(field_name: str) -> str:
    """As protoc names the message behind a map field."""
    return "".join(part[:1].upper() + part[1:] for part in field_name.split("_")) + "Entry"


def _entry_fields(type_: Map) -> tuple[Field, ...]:
    key, value = map_entry(type_.key, type_.value).fields
    return Field(key.name, Optional(key.type), 1), Field(value.name, Optional(value.type), 2)


class EnumClass:
    """What stands for an enum in a message class: `Image.ColorMode.Value("COLOR_RGB")`, `.Name(0)`, `.COLOR_RGB`."""

    def __init__(self, enum: Enum) -> None:
        self.DESCRIPTOR = enum_descriptor(enum)

    def Name(self, number: int) -> str:  # noqa: N802  as protobuf names it
        """The name of a number."""
        if isinstance(number, bool) or not isinstance(number, int):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise TypeError(f"Enum value for {self.DESCRIPTOR.name} must be an int, but got {type(number)} {number!r}.")
        if number not in self.DESCRIPTOR.values_by_number:
            raise ValueError(f"Enum {self.DESCRIPTOR.name} has no name defined for value {number!r}")
        return self.DESCRIPTOR.values_by_number[number].name

    def Value(self, name: str) -> int:  # noqa: N802  as protobuf names it
        """The number of a name."""
        if name not in self.DESCRIPTOR.values_by_name:
            raise ValueError(f"Enum {self.DESCRIPTOR.name} has no value defined for name {name!r}")
        return self.DESCRIPTOR.values_by_name[name].number

    def keys(self) -> list[str]:
        return [value.name for value in self.DESCRIPTOR.values]

    def values(self) -> list[int]:
        return [value.number for value in self.DESCRIPTOR.values]

    def items(self) -> list[tuple[str, int]]:
        return [(value.name, value.number) for value in self.DESCRIPTOR.values]

    def __getattr__(self, name: str) -> int:
        if name != "DESCRIPTOR" and name in self.DESCRIPTOR.values_by_name:
            return self.DESCRIPTOR.values_by_name[name].number
        raise AttributeError(name)
