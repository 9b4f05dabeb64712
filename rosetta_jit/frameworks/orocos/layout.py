"""Where the members of a struct lie in memory: the rules of the Itanium C++ ABI (2.2, POD types) for x86-64, and sizes of libstdc++.

A member lies at the next multiple of its alignment, a struct is as aligned as its most aligned member, and its size is a multiple of that.
Where something else is true (base classes, ``alignas``, packed structs), a front end pins it down in options: ``offset`` of a field in
bytes, ``size`` and ``alignment`` of a struct.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import assert_never

from rosetta_jit.frameworks.orocos.limits import MAX_PADDING
from rosetta_jit.model.types import (
    Array,
    Bool,
    Bytes,
    Declaration,
    Enum,
    Field,
    Float,
    Int,
    Map,
    Optional,
    Ref,
    String,
    Struct,
    Type,
    Union,
)
from rosetta_jit.startup.dataclass import dataclass, field, replace

UNDERLYING = "underlying"
"""The option of a field whose enum is not an int: the scalar that it is instead."""

_ENUM_BYTES = {"i8": 1, "u8": 1, "i16": 2, "u16": 2, "i32": 4, "u32": 4}


@dataclass(frozen=True, slots=True)
class Extent:
    """Size and alignment in bytes."""

    size: int
    alignment: int


@dataclass(frozen=True, slots=True)
class Place:
    """A field, and the bytes from ``offset`` to ``end`` where it lies."""

    field: Field
    offset: int
    end: int


VECTOR, BOOLEANS, STRING = Extent(24, 8), Extent(40, 8), Extent(32, 8)
"""std::vector, std::vector<bool> and std::string of libstdc++ (with the C++11 ABI)."""


@dataclass(frozen=True, slots=True)
class Layouts:
    """Layouts of the structs of a schema; each is computed once."""

    types: Mapping[str, Declaration]
    known: dict[str, Extent] = field(default_factory=dict[str, Extent])

    def places(self, struct: Struct) -> tuple[Place, ...]:
        """The offset of each field."""
        places: list[Place] = []
        end = 0
        for each in struct.fields:
            extent = self.of_field(each)
            pinned = each.option("offset")
            offset = pinned if isinstance(pinned, int) else aligned(end, extent.alignment)
            end = offset + extent.size
            places.append(Place(each, offset, end))
        return tuple(places)

    def of_struct(self, struct: Struct) -> Extent:
        """The whole struct; one without members has a byte of its own."""
        if struct.name not in self.known:
            pinned, size = struct.option("alignment"), struct.option("size")
            alignment = pinned if isinstance(pinned, int) else self.natural_alignment(struct)
            end = max((place.end for place in self.places(struct)), default=0)
            self.known[struct.name] = Extent(size if isinstance(size, int) else aligned(max(end, 1), alignment), alignment)
        return self.known[struct.name]

    def natural_alignment(self, struct: Struct) -> int:
        """The greatest alignment of the members."""
        return max((self.of_field(each).alignment for each in struct.fields), default=1)

    def of_field(self, field: Field) -> Extent:
        """A member."""
        underlying = field.option(UNDERLYING)
        return self.of_type(field.type, underlying if isinstance(underlying, str) else "i32")

    def of_type(self, type_: Type, underlying: str = "i32") -> Extent:
        """A value of a type; ``underlying`` is what an enum is."""
        match type_:
            case Bool():
                return Extent(1, 1)
            case Int(bits) | Float(bits):
                return Extent(bits // 8, bits // 8)
            case Enum():
                return Extent(_ENUM_BYTES[underlying], _ENUM_BYTES[underlying])
            case String():
                return STRING
            case Bytes(length=int(length)):
                return Extent(length, 1)
            case Bytes():
                return VECTOR
            case Array(element, int(length)):
                each = self.of_type(element, underlying)
                return Extent(each.size * length, each.alignment)
            case Array(element):
                return BOOLEANS if isinstance(element, Bool) else VECTOR
            case Ref(name):
                return self.of_type(self.types[name], underlying)
            case Struct():
                return self.of_struct(type_)
            case Map() | Optional() | Union():
                raise AssertionError(type_)
            case _:
                assert_never(type_)


def pinned(struct: Struct, offsets: Sequence[int | None], size: int, alignment: int | None, layouts: Layouts) -> Struct:
    """The struct with options for all that the rules alone would not give."""
    fields: list[Field] = []
    end = 0
    for each, offset in zip(struct.fields, offsets, strict=True):
        extent = layouts.of_field(each)
        natural = aligned(end, extent.alignment)
        known = natural if offset is None else offset
        fields.append(each if known == natural else replace(each, options=_with(each.options, "offset", known)))
        end = known + extent.size
    options = struct.options
    if alignment is not None and alignment != layouts.natural_alignment(struct):
        options = _with(options, "alignment", alignment)
    if size != aligned(max(end, 1), alignment or layouts.natural_alignment(struct)):
        options = _with(options, "size", size)
    return replace(struct, fields=tuple(fields), options=options)


def unaccounted(struct: Struct, layouts: Layouts) -> Field | Struct | None:
    """The first member that lies on another one, or behind more padding than is plausible; or the struct, if it ends so."""
    end = 0
    for place in layouts.places(struct):
        if not 0 <= place.offset - end <= MAX_PADDING:
            return place.field
        end = place.end
    return struct if not 0 <= layouts.of_struct(struct).size - end <= MAX_PADDING else None


def aligned(offset: int, alignment: int) -> int:
    """The next multiple of the alignment."""
    return -(-offset // alignment) * alignment


def _with(options: tuple[tuple[str, bool | int | float | str | bytes], ...], name: str, value: int) -> tuple[tuple[str, int | str], ...]:
    return tuple(sorted([*options, (name, value)]))  # pyright: ignore[reportReturnType] - sorted by name, which is unique
