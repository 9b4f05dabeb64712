"""How Protocol Buffers write a type: tagged fields (developers.google.com/protocol-buffers, "Encoding")."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.model.layout import map_entry
from rosetta_jit.model.recursive_structs import recursive_structs
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Blob, Codec, Count, Encoding, Entry, Number, Path, Recursion, Tagged, Varint, WireType

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Choices

FIXED: dict[str, tuple[str, WireType]] = {
    "fixed32": ("u32", 5),
    "sfixed32": ("i32", 5),
    "float": ("f32", 5),
    "fixed64": ("u64", 1),
    "sfixed64": ("i64", 1),
    "double": ("f64", 1),
}
"""Types of a fixed width, by the word of the IDL."""

LENGTH = Count("varint")


PARTIAL = "protobuf-partial"
"""The same bytes, but required fields need not come and need not be set, as in Python's ``ParseFromString``."""


def encode_type(struct: Struct, schema: Schema, name: str, choices: Choices) -> Encoding:  # noqa: ARG001 - there is nothing to choose
    """The encoding of a message type."""
    messages = _Messages(schema, recursive_structs(Ref(struct.name), schema), partial=name == PARTIAL)
    root = messages.message(struct, (), delimited=False)
    reached = {each: messages.message(schema.struct(each), (), delimited=True) for each in sorted(messages.recursive)}
    return Encoding(name, (root,), root, reached)


@dataclass(frozen=True, slots=True)
class _Messages:
    schema: Schema
    recursive: frozenset[str]
    partial: bool = False

    def message(self, struct: Struct, path: Path, *, delimited: bool, group: int | None = None) -> Tagged:
        entries = tuple(entry for each in struct.fields for entry in self.entries(each))
        required = tuple(each.name for each in struct.fields if each.required and not self.partial)
        return Tagged(path, tuple(sorted(entries, key=lambda entry: entry.number)), required, delimited, group)

    def entries(self, field: Field) -> list[Entry]:
        match field.type:
            case Union(_, cases):
                return [entry for case in cases for entry in self.cases(field.name, case)]
            case Array(element, _):
                label = "packed" if field.option("packed") else "repeated"
                return [self.entry(field, element, (field.name,), label)]
            case Map(key, value):
                return [Entry(_number(field), 2, (field.name,), self.map_entry(key, value), "repeated")]
            case Optional(value):
                return [self.entry(field, value, (field.name,), "single")]
            case other:
                return [self.entry(field, other, (field.name,), "single", implicit=True)]

    def map_entry(self, key: Type, value: Type) -> Tagged:
        """An entry of a map is a message of two fields, which are always written; one that does not come is zero."""
        fields = [Field(each.name, each.type, number) for number, each in enumerate(map_entry(key, value).fields, 1)]
        entries = tuple(self.entry(each, each.type, (each.name,), "single") for each in fields)
        return Tagged((), entries, delimited=True, whole=any(each.allowed for each in entries))

    def cases(self, union: str, case: Field) -> list[Entry]:
        return [self.entry(case, case.type, (union, case.name), "single")]

    def entry(self, field: Field, type_: Type, path: Path, label: str, *, implicit: bool = False) -> Entry:
        """A field; elements of an array are known by the path of the array."""
        number = _number(field)
        group = number if field.option("group") else None
        wire, value = self.value(type_, () if label != "single" else path, group)
        resolved = self.schema.resolve(type_)
        allowed = tuple(sorted({each for _, each in resolved.values})) if isinstance(resolved, Enum) and resolved.closed else ()
        match label:
            case "packed" | "repeated":
                return Entry(number, wire, path, value, label, allowed=allowed)
            case _:
                return Entry(number, wire, path, value, "single", implicit, allowed)

    def value(self, type_: Type, path: Path, group: int | None) -> tuple[WireType, Codec]:
        match type_:
            case Ref(name) if name in self.recursive:
                return (2 if group is None else 3), Recursion(path, name, group)
            case Ref(name):
                declared = self.schema.types[name]
                if isinstance(declared, Enum):
                    return 0, Varint(path)
                return (2 if group is None else 3), self.message(declared, path, delimited=group is None, group=group)
            case Int(_, _, spelling) | Float(_, spelling) if spelling in FIXED:
                scalar, wire = FIXED[spelling]
                return wire, Number(path, scalar)
            case Int(_, _, spelling):
                return 0, Varint(path, zigzag=spelling.startswith("sint"))
            case Bool() | Enum():
                return 0, Varint(path)
            case String():
                return 2, Blob(path, LENGTH, text=True)
            case Bytes():
                return 2, Blob(path, LENGTH)
            case Struct():
                return 2, self.message(type_, path, delimited=True)
            case Float() | Array() | Map() | Optional() | Union():
                raise AssertionError(type_)
            case _:
                assert_never(type_)


def _number(field: Field) -> int:
    assert field.number is not None, field
    return field.number
