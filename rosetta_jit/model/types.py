r"""The meta-model: what data of every framework looks like, without a word about bytes.

    Type   = Bool | Int | Float | String | Bytes | Enum | Array | Struct | Union | Optional | Map | Ref
    Struct = name, Field*          Field = name, Type, number, unit, part_units, constant, default, ...
    Union  = name, Field*          one of the fields is set, or none (a protobuf oneof)

A union with a discriminator (OMG IDL) is a struct of two fields, ``_d`` and such a union, which knows the labels of its cases.

Scalars carry the word that their IDL uses (`spelling`): two IDL types with the same values but other bytes (`int32` and
`sint32`, `:int` and `:vocab`) are the same model type, and the encoding tells them apart by that word alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rosetta_jit.model.scalars import Bool, Enum, Float, Int, String
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.source import Span

Constant = bool | int | float | str | bytes
"""A value that an IDL can write down."""


@dataclass(frozen=True, slots=True)
class Bytes:
    """Bytes without a meaning of their own; ``length`` and ``maximum`` as of an `Array`."""

    spelling: str = ""
    length: int | Expr | None = None
    maximum: int | None = None


@dataclass(frozen=True, slots=True)
class Array:
    """A sequence of one element type.

    Parameters
    ----------
    length
        Where the type fixes it; an expression where other fields of the struct around it tell it, and the wire has no count (LCM).
    maximum
        The bound on it, where there is one.
    """

    element: Type
    length: int | Expr | None = None
    maximum: int | None = None

    @property
    def fixed(self) -> int | None:
        """The length, if the type alone tells it."""
        return self.length if isinstance(self.length, int) else None


@dataclass(frozen=True, slots=True)
class Optional:
    """A value that may be absent, and knows whether it is."""

    value: Type


@dataclass(frozen=True, slots=True)
class Map:
    """Pairs of key and value; the last of equal keys counts. ``maximum`` bounds how many there are."""

    key: Type
    value: Type
    maximum: int | None = None


@dataclass(frozen=True, slots=True)
class Ref:
    """A named type, looked up in the schema. Recursion goes through here and nowhere else."""

    name: str
    span: Span | None = field(default=None, compare=False, repr=False)


PartUnit = tuple[tuple["str | int | None", ...], str]
"""The unit of a part of a value, and the way to it: names of members, numbers of elements, None for each element."""


@dataclass(frozen=True, slots=True)
class Field:
    """A member of a struct or a case of a union.

    Parameters
    ----------
    number
        The tag by which the IDL knows the field on the wire, where it has one.
    unit
        Unit of the values as the IDL names it (``degree``), where it says so; of all numbers within, where nothing nearer says another.
    part_units
        Units of parts of the value, where they are not all the same.
    constant
        The one value that the field can have; the wire must carry it and packing writes it. An expression may read
        fields of the same message.
    length
        Number of elements or bytes, computed from other fields; the wire must agree.
    default
        What reading an absent value gives.
    required
        The IDL demands that the field be set (proto2 ``required``).
    options
        What else the IDL says that an encoding must know (``packed``, ``group``), as sorted pairs.
    """

    name: str
    type: Type
    number: int | None = None
    unit: str | None = None
    constant: Expr | None = None
    length: Expr | None = None
    default: Constant | None = None
    required: bool = False
    options: tuple[tuple[str, Constant], ...] = ()
    part_units: tuple[PartUnit, ...] = ()
    doc: str = field(default="", compare=False)
    span: Span | None = field(default=None, compare=False, repr=False)

    def option(self, name: str) -> Constant | None:
        """The value of an option, or None where the IDL does not give it."""
        return dict(self.options).get(name)


@dataclass(frozen=True, slots=True)
class NamedConstant:
    """A name that an IDL gives to a value."""

    name: str
    type: Type
    value: Constant
    doc: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Struct:
    """Named fields in order. ``name`` is qualified: ``rst.vision.Image``.

    ``options`` is what else the IDL says that an encoding or the manners must know (``extensibility``), as sorted pairs.
    """

    name: str
    fields: tuple[Field, ...]
    doc: str = field(default="", compare=False)
    span: Span | None = field(default=None, compare=False, repr=False)
    constants: tuple[NamedConstant, ...] = ()
    options: tuple[tuple[str, Constant], ...] = ()

    def option(self, name: str) -> Constant | None:
        """The value of an option, or None where the IDL does not give it."""
        return dict(self.options).get(name)


@dataclass(frozen=True, slots=True)
class Union:
    """At most one of several fields.

    Where a field beside it tells which, ``discriminator`` is that field's name, ``labels`` are its values for each case, and the case
    numbered ``default`` is that of every other value.
    """

    name: str
    cases: tuple[Field, ...]
    span: Span | None = field(default=None, compare=False, repr=False)
    discriminator: str = ""
    labels: tuple[tuple[int, ...], ...] = ()
    default: int | None = None


def name_parts(name: str) -> tuple[str, ...]:
    """The parts of a qualified name, however its framework writes them; ROS 2 says in the middle that it is a message."""
    parts = tuple(part for part in name.replace("::", "/").replace(".", "/").split("/") if part)
    return (*parts[:-2], parts[-1]) if len(parts) > 2 and parts[-2] == "msg" else parts


def same_name(one: str, other: str) -> bool:
    """Whether two qualified names are one: ``sensor_msgs/JointState`` and ``sensor_msgs/msg/JointState`` are."""
    return one == other or name_parts(one) == name_parts(other)


Type = Bool | Int | Float | String | Bytes | Enum | Array | Struct | Union | Optional | Map | Ref

Declaration = Struct | Enum


@dataclass(frozen=True, slots=True)
class Schema:
    """Declared types and constants by qualified name, and the sources that they were read from.

    ``left_out`` says why declarations that the meta-model cannot represent are missing.

    A `Ref` names a key of ``types``; the front end has made all names absolute.
    """

    types: Mapping[str, Declaration]
    sources: tuple[str, ...] = ()
    constants: Mapping[str, NamedConstant] = field(default_factory=dict[str, "NamedConstant"])
    left_out: Mapping[str, Diagnostic] = field(default_factory=dict[str, "Diagnostic"])

    def resolve(self, type_: Type) -> Type:
        """The declared type behind a reference; every other type is itself."""
        return self.types[type_.name] if isinstance(type_, Ref) else type_

    def struct(self, name: str) -> Struct:
        """The struct of a name that is known to be one's."""
        found = self.types[name]
        assert isinstance(found, Struct)
        return found
