"""How OROCOS writes a C++ object, on x86-64 (nothing on the wire says so; the receiver must know type and platform).

``rtt-mqueue``: members one after another without padding, as RTT's mqueue transport archives them (rtt/transports/mqueue,
binary_data_archive.hpp): a vector is its 64-bit size and its elements, an array its elements alone, an enum its underlying integer.

``typelib``: the memory of the object with its padding (typelib/memory_layout.cc, value_ops.cc), containers replaced by their 64-bit size
and their elements. Padding at the very end of the object is left out; at the end of elements it is not.

``native``: the memory of the object, which must hold no containers: RTT's transport of types that are trivially copyable.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.orocos import diagnostics as words
from rosetta_jit.frameworks.orocos.layout import UNDERLYING, Layouts
from rosetta_jit.frameworks.orocos.limits import MAX_FIELDS
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.recursive_structs import recursive_structs
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Blob, Codec, Count, Encoding, Number, Padding, Path, Recursion, Repeat, Seq, Table

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Choices

PACKED, DUMPED, MEMORY = "rtt-mqueue", "typelib", "native"

SIZE = Count("u64")
BOOLEANS = ((0, 0), (1, 1))

_NARROW = {"i8": range(-(1 << 7), 1 << 7), "u8": range(1 << 8), "i16": range(-(1 << 15), 1 << 15), "u16": range(1 << 16)}


def encode_type(struct: Struct, schema: Schema, name: str, choices: Choices) -> Encoding:
    """The encoding of a type; lenient for ``bool``, it takes every byte but 0 for true.

    Raises
    ------
    SchemaError
        If the encoding cannot carry a member, or the type is too large.
    """
    layouts = Layouts(schema.types)
    if _leaves(struct, schema, {}) > MAX_FIELDS:
        raise SchemaError((words.unfolds(struct.span, struct.name, MAX_FIELDS),))
    objects = _Objects(schema, layouts, name, recursive_structs(Ref(struct.name), schema), "bool" in choices.lenient)
    items = objects.members(struct, ())
    if name == DUMPED:
        items = _without_end(items)
    root = Seq(items)
    nested = {each: Seq(objects.members(schema.struct(each), ())) for each in sorted(objects.recursive)}
    return Encoding(name, (root,), root, nested=(nested,) if nested else ())


@dataclass(frozen=True, slots=True)
class _Objects:
    schema: Schema
    layouts: Layouts
    name: str
    recursive: frozenset[str]
    any_bool: bool

    def members(self, struct: Struct, path: Path) -> tuple[Codec, ...]:
        """The members of a struct, and the padding around them where it is written."""
        if self.name == PACKED:
            return tuple(item for each in struct.fields for item in self.member(each, path))
        items: list[Codec] = []
        end = 0
        for place in self.layouts.places(struct):
            items += (*_padding(place.offset - end), *self.member(place.field, path))
            end = place.end
        return (*items, *_padding(self.layouts.of_struct(struct).size - end))

    def member(self, field: Field, path: Path) -> tuple[Codec, ...]:
        return self.value(field, field.type, (*path, field.name))

    def value(self, field: Field, type_: Type, path: Path) -> tuple[Codec, ...]:
        """A value of a type, which is that of a field or of elements below it."""
        resolved = self.schema.resolve(type_)
        match resolved:
            case Struct() if resolved.name in self.recursive:
                if self.name == DUMPED:
                    raise SchemaError((words.not_in_typelib(field.span, field.name, "leads back to its own type"),))
                return (Recursion(path, resolved.name),)
            case Struct():
                return self.members(resolved, path)
            case Bool():
                return (Number(path, "u8") if self.any_bool else Table(path, "u8", BOOLEANS),)
            case Int() | Float():
                return (Number(path, scalar_of(resolved)),)
            case Enum():
                return (_enum(field, path),)
            case String() | Bytes():
                return (Blob(path, self.count(field, resolved)),)
            case Array(element):
                if self.name == DUMPED and isinstance(element, Bool) and resolved.length is None:
                    raise SchemaError((words.not_in_typelib(field.span, field.name, "of type std::vector<bool>"),))
                return (Repeat(path, self.count(field, resolved), _sequence(self.value(field, element, ()))),)
            case Map() | Optional() | Union() | Ref():
                raise AssertionError(resolved)
            case _:
                assert_never(resolved)

    def count(self, field: Field, type_: Array | Bytes | String) -> Count:
        """The codec of the count before elements: nothing if the type fixes their number."""
        length = None if isinstance(type_, String) else type_.length
        if isinstance(length, int):
            return Count(None, value=length)
        if self.name == MEMORY:
            raise SchemaError((words.not_plain_memory(field.span, field.name),))
        return SIZE


def _enum(field: Field, path: Path) -> Codec:
    """The underlying integer. A holder has room for 32 bits, so a narrower one is checked when it is written."""
    scalar = field.option(UNDERLYING)
    if isinstance(scalar, str) and scalar in _NARROW:
        return Table(path, scalar, tuple((number, number) for number in _NARROW[scalar]))
    return Number(path, "i32")


def _padding(size: int) -> tuple[Padding, ...]:
    """Bytes of no meaning, in few numbers."""
    words_, rest = divmod(size, 8)
    sizes = ("u64",) * words_ + tuple(scalar for scalar, width in (("u32", 4), ("u16", 2), ("u8", 1)) if rest & width)
    return tuple(Padding(scalar, 0) for scalar in sizes)


def _without_end(items: tuple[Codec, ...]) -> tuple[Codec, ...]:
    """Without the padding after the last member, and after the last member of that."""
    kept = len(items)
    while kept and isinstance(items[kept - 1], Padding):
        kept -= 1
    return items[:kept]


def _sequence(items: tuple[Codec, ...]) -> Codec:
    return items[0] if len(items) == 1 else Seq(items)


def _leaves(type_: Type, schema: Schema, known: dict[str, int]) -> int:
    """How many numbers and arrays a type unfolds to; the way back to a recursive struct counts as one."""
    match schema.resolve(type_):
        case Array(element):
            return 1 + _leaves(element, schema, known)
        case Struct(name, fields):
            if name not in known:
                known[name] = 1
                known[name] = sum(_leaves(each.type, schema, known) for each in fields) or 1
            return known[name]
        case _:
            return 1
