"""Common Data Representation, in which CORBA and DDS write a type.

cdr-giop    CORBA 3.3 part 2, 9.3: no header, the byte order is told elsewhere
cdr         DDS-XTypes 1.3, 7.4.1 (XCDR1), behind an encapsulation header of four bytes that says the byte order
cdr2        DDS-XTypes 1.3, 7.4.3 (XCDR2): nothing is aligned to more than four bytes, and what may change has its size before it

Everything is written at a multiple of its size from the origin, behind the header: that rule is `_Rules.aligned`, and nowhere else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.omg import diagnostics as words
from rosetta_jit.model.layout import map_entry, scalar_of
from rosetta_jit.model.recursive_structs import recursive_structs
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.wire import codec as wire
from rosetta_jit.wire.align import ANYWHERE, ORIGIN, Phase, leading, settle
from rosetta_jit.wire.recursion import MAX_OPEN_SIZES, open_sizes, recurses
from rosetta_jit.wire.size import WIDTH

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Choices

HEADER_BYTES = 4
IDENTIFIERS = {
    "cdr": {"final": 0x00, "appendable": 0x00, "mutable": 0x02},
    "cdr2": {"final": 0x06, "appendable": 0x08, "mutable": 0x0A},
}
"""Representation identifiers (DDS-XTypes 1.3, table 60), of the big-endian form; the little-endian one is one more."""
PADDING_OF_PAYLOADS = 3
OPTIONS = 3
"""The byte of the header whose last two bits say how many bytes of padding are behind the value (DDS-XTypes 1.3, 7.6.3.1.2)."""
ENDINGS = {"cdr": wire.Ending(OPTIONS, unstated=4), "cdr2": wire.Ending(OPTIONS, align=4)}
"""XCDR2 is written with the padding that the specification asks for; XCDR1 as ROS 2 has it, without any or with untold zeros."""
SENTINEL = 0x7F02
"""The end of a list of parameters, which must be understood (DDS-XTypes 1.3, 7.4.1.2.1)."""
DUAL_USE = {1: 5, 4: 6, 8: 7}
"""Length codes of sequences whose count is also their length, by the size of their elements."""


def encode_type(struct: Struct, schema: Schema, name: str, choices: Choices) -> wire.Encoding:
    """The encoding of a message."""
    orders: dict[str | None, tuple[wire.Order, ...]] = {"little": ("<",), "big": (">",), None: ("<",) if name == "cdr-giop" else ("<", ">")}
    attempts: list[wire.Codec] = []
    nested: list[dict[str, wire.Codec]] = []
    recursive = recursive_structs(Ref(struct.name), schema)
    for order in orders[choices.byte_order]:
        rules = _Rules(schema, name, order, recursive, choices.lenient)
        attempts.append(rules.message(struct))
        nested += [{each: rules.settled(rules.struct(schema.struct(each), ()), ANYWHERE) for each in sorted(recursive)}]
    for each in recursive:
        if any(open_sizes(codecs[each]) > MAX_OPEN_SIZES for codecs in nested):
            raise SchemaError((words.deep_recursion(schema.struct(each).span, each, MAX_OPEN_SIZES),))
    origin = 0 if name == "cdr-giop" else HEADER_BYTES
    spare = PADDING_OF_PAYLOADS if "trailing" in choices.lenient else 0
    recursion = tuple(nested) if recursive else ()
    return wire.Encoding(
        name,
        tuple(attempts),
        attempts[0],
        nested=recursion,
        origin=origin,
        ending=_ending(name, choices),
        spare=spare,
        forgivable=PADDING_OF_PAYLOADS,
        rare=wire.Rare(_opening(name, struct, ">"), "big")
        if len(attempts) > 1
        else None,  # no machine that is still built writes it untold
    )


def _opening(encoding: str, struct: Struct, order: wire.Order) -> bytes:
    """The representation identifier of a message."""
    return bytes((0, IDENTIFIERS[encoding][_extensibility(struct)] + (order == "<")))


def _ending(name: str, choices: Choices) -> wire.Ending | None:
    ending = ENDINGS.get(name)
    return replace(ending, align=ending.unstated) if ending is not None and "padding" in choices.lenient else ending


@dataclass(frozen=True, slots=True)
class _Rules:
    """How values are written in one encoding and byte order."""

    schema: Schema
    encoding: str
    order: wire.Order
    recursive: frozenset[str]
    lenient: frozenset[str]

    @property
    def second(self) -> bool:
        return self.encoding == "cdr2"

    def message(self, struct: Struct) -> wire.Codec:
        body = self.settled(self.struct(struct, ()), ORIGIN)
        return body if self.encoding == "cdr-giop" else wire.Seq((*self.header(struct), body))

    def settled(self, codec: wire.Codec, phase: Phase) -> wire.Codec:
        return settle(codec, phase)[0]

    def header(self, struct: Struct) -> tuple[wire.Codec, ...]:
        """The representation identifier, and two bytes of options, of which the `Ending` is the last."""
        return wire.Constant((), _opening(self.encoding, struct, self.order)), wire.Padding("u16", 0)

    def aligned(self, codec: wire.Codec, size: int) -> wire.Codec:
        return wire.Seq((wire.Align(min(size, 4 if self.second else 8)), codec))

    # --- structs and unions ------------------------------------------------------------------------------------------

    def struct(self, struct: Struct, path: wire.Path) -> wire.Codec:
        extensibility = _extensibility(struct)
        if extensibility == "mutable":
            return self.mutable(struct, path)
        body = self.members(struct, path)
        return self.sized(body, path) if self.second and extensibility == "appendable" else body

    def sized(self, codec: wire.Codec, path: wire.Path) -> wire.Codec:
        """With the number of its bytes before it (DHEADER)."""
        return self.aligned(wire.Delimited(path, codec, self.order), 4)

    def members(self, struct: Struct, path: wire.Path) -> wire.Codec:
        if not struct.fields:  # rosidl gives a struct without members one, which it calls structure_needs_at_least_one_member
            return wire.Padding("u8", 0)
        union = next((each.type for each in struct.fields if isinstance(each.type, Union) and each.type.discriminator), None)
        discriminators = () if union is None else (union.discriminator,)
        return wire.Seq(tuple(self.field(each, path, struct) for each in struct.fields if each.name not in discriminators))

    def field(self, field: Field, path: wire.Path, struct: Struct) -> wire.Codec:
        own = (*path, field.name)
        match field.type:
            case Union() as union:
                return self.union(union, own, struct)
            case Optional(value):
                return wire.Maybe(own, self.value(value, own, field)) if self.second else self.optional(field, own, struct)
            case type_:
                return self.value(type_, own, field)

    def union(self, union: Union, path: wire.Path, struct: Struct) -> wire.Codec:
        teller = next(each for each in struct.fields if each.name == union.discriminator)
        discriminator = self.value(teller.type, (*path[:-1], teller.name), teller)
        cases = tuple((labels, self.field(case, path, struct)) for labels, case in zip(union.labels, union.cases, strict=True))
        return wire.Cases(path, discriminator, cases, union.default)

    def optional(self, field: Field, path: wire.Path, struct: Struct) -> wire.Codec:
        if self.encoding == "cdr-giop":
            raise SchemaError((words.no_optionals(field.span, field.name),))
        return self.aligned(wire.Parameter(self.member(field, struct.fields.index(field), path), self.order), 4)

    def mutable(self, struct: Struct, path: wire.Path) -> wire.Codec:
        if self.encoding == "cdr-giop":
            raise SchemaError((words.no_mutables(struct.span, struct.name),))
        union = next((each for each in struct.fields if isinstance(each.type, Union) and each.type.discriminator), None)
        if union is not None:
            return self.mutable_union(union, path, struct)
        members = tuple(self.member(each, number, (*path, each.name)) for number, each in enumerate(struct.fields))
        kind = wire.Members if self.second else wire.Parameters
        return self.aligned(kind(path, members, self.order), 4)

    def member(self, field: Field, position: int, path: wire.Path) -> wire.Member:
        optional = isinstance(field.type, Optional)
        value = self.value(field.type.value if isinstance(field.type, Optional) else field.type, path, field)
        if recurses(value):
            raise SchemaError((words.recursive_parameter(field.span, field.name),))
        number = position if field.number is None else field.number
        must = bool(field.option("must_understand"))
        owed = must or bool(field.option("key"))  # without these no two types are one (DDS-XTypes 1.3, 7.2.4.4.8)
        return wire.Member(number, path, value, self.length_code(field.type), optional, must, owed)

    def mutable_union(self, field: Field, path: wire.Path, struct: Struct) -> wire.Codec:
        """The discriminator as a member with the id 0, then the case that it selects as another (DDS-XTypes 1.3, 7.4.3.5.3)."""
        union = field.type
        assert isinstance(union, Union)
        teller = next(each for each in struct.fields if each.name == union.discriminator)
        own = (*path, field.name)
        discriminator = self.placed(replace(self.member(teller, 0, (*path, teller.name)), must_understand=True))
        cases = tuple(
            (labels, self.placed(self.member(case, number, (*own, case.name))))
            for number, (labels, case) in enumerate(zip(union.labels, union.cases, strict=True), 1)
        )
        body = wire.Cases(own, discriminator, cases, union.default)
        if self.second:
            return self.sized(body, path)
        return wire.Seq((body, wire.Align(4), wire.Constant((), SENTINEL, "u16", self.order), wire.Constant((), 0, "u16", self.order)))

    def placed(self, member: wire.Member) -> wire.Codec:
        """A member of a mutable union; its length has a word of its own, as Cyclone DDS writes it."""
        return self.aligned(wire.Parameter(replace(member, length_code=4, optional=False), self.order, self.second), 4)

    def length_code(self, type_: Type) -> int:
        """How the length of a member is told: by the code, by a word of its own, or by its first word."""
        match self.schema.resolve(type_):
            case Bool() | Int() | Float() | Enum() as scalar:
                size = scalar.bits // 8 if isinstance(scalar, Enum) else WIDTH[scalar_of(scalar)]
                return {1: 0, 2: 1, 4: 2, 8: 3}[size]
            case String() | Bytes(length=None):
                return DUAL_USE[1]
            case Array(_, length) as array:
                primitive = self.primitive_element(array)
                if primitive is None:
                    return DUAL_USE[1]
                return 4 if length is not None else DUAL_USE.get(primitive, 4)
            case Optional(value):
                return self.length_code(value)
            case _:
                return 4

    def primitive_element(self, array: Array) -> int | None:
        """The size of primitive elements, for which XCDR2 writes no DHEADER. All fixed dimensions are those of one array."""
        match array.element:
            case Array(length=int()) as inner if array.fixed is not None:
                return self.primitive_element(inner)
            case Bytes(length=int()) if array.fixed is not None:
                return 1
            case element:
                return self.primitive(element)

    def primitive(self, type_: Type) -> int | None:
        """The size of a primitive type; None for all others, enums among them."""
        return WIDTH[scalar_of(type_)] if isinstance(type_, Bool | Int | Float) else None

    # --- values ------------------------------------------------------------------------------------------------------

    def value(self, type_: Type, path: wire.Path, field: Field) -> wire.Codec:
        match type_:
            case Bool():
                absent = int(field.default is True)
                strict = wire.Table(path, "u8", ((0, 0), (1, 1)), absent=absent)
                return wire.Number(path, "bool", absent=absent) if "bool" in self.lenient else strict
            case Int(16, _, "wchar") if self.encoding == "cdr-giop":
                return wire.Seq((wire.Constant(path[:0], 2, "u8", kind="count"), wire.Number(path, "u16", ">")))
            case Int() | Float():
                scalar = scalar_of(type_)
                absent = field.default if isinstance(field.default, int | float) else 0
                return self.aligned(wire.Number(path, scalar, self.order, absent), WIDTH[scalar])
            case Enum():
                return self.enumerator(type_, path, field)
            case String():
                return self.string(type_, path, field)
            case Bytes(_, length, maximum):
                blob = wire.Blob(path, wire.Count(None, value=length), absent=field.default if isinstance(field.default, bytes) else b"")
                return blob if length is not None else self.counted(replace(blob, count=self.count(maximum)))
            case Array():
                return self.array(type_, path, field)
            case Map(key, value, maximum):
                entry = wire.Seq(tuple(self.field(each, (), Struct("", ())) for each in map_entry(key, value).fields))
                if recurses(entry):
                    raise SchemaError((words.nested_recursion(field.span, field.name),))
                repeat = self.counted(wire.Repeat(path, self.count(maximum), entry, align=leading(entry)))
                plain = self.primitive(key) is not None and self.primitive(value) is not None
                return self.sized(repeat, path) if self.second and not plain else repeat
            case Ref(name) if name in self.recursive:
                return wire.Repeat(path, wire.Count(None, value=1), wire.Recursion((), name))
            case Ref(name):
                declared = self.schema.types[name]
                return self.enumerator(declared, path, field) if isinstance(declared, Enum) else self.struct(declared, path)
            case Struct():
                return self.struct(type_, path)
            case Optional() | Union():
                raise SchemaError((words.no_such_scalar(field.span, field.name),))
            case _:
                assert_never(type_)

    def enumerator(self, enum: Enum, path: wire.Path, field: Field) -> wire.Codec:
        scalar, size = f"i{enum.bits}", enum.bits // 8
        numbers = dict(enum.values)
        default = numbers.get(field.default) if isinstance(field.default, str) else field.default
        absent = default if isinstance(default, int) else next(iter(numbers.values()), 0)
        if "enum" in self.lenient:
            return self.aligned(wire.Number(path, scalar, self.order, absent), size)
        pairs = tuple((number, number) for number in sorted(set(numbers.values())))
        return self.aligned(wire.Table(path, scalar, pairs, self.order, absent), size)

    def string(self, string: String, path: wire.Path, field: Field) -> wire.Codec:
        default = field.default if isinstance(field.default, str) else ""
        if string.encoding == "utf-16":
            return self.counted(self.wide_string(string, path, default))
        data = default.encode("utf-8", "surrogateescape")
        return self.counted(wire.Blob(path, self.count(string.maximum), text=string.encoding == "utf-8", terminated=True, absent=data))

    def wide_string(self, string: String, path: wire.Path, default: str) -> wire.Codec:
        """On DDS its bytes are counted, and there is no mark (DDS-XTypes 1.3, 7.4.1.1.2); what ROS 2 does instead is a leniency."""
        counted = self.count(string.maximum)
        if self.encoding == "cdr-giop":
            return wire.Utf16(path, replace(counted, unit=2))
        data = default.encode("utf-16-le", "surrogatepass")
        absent = tuple(int.from_bytes(data[each : each + 2], "little") for each in range(0, len(data), 2))
        unit = wire.Number((), "u16", self.order)
        if "wstring" not in self.lenient:
            return wire.Repeat(path, replace(counted, unit=2), unit, absent=absent)
        halves = (unit, wire.Constant((), 0, "u16", self.order))
        return wire.Repeat(path, counted, wire.Seq(halves if self.order == "<" else halves[::-1]), absent=absent)

    def counted(self, codec: wire.Codec) -> wire.Codec:
        return self.aligned(codec, 4)

    def count(self, maximum: int | None) -> wire.Count:
        return wire.Count("u32", self.order, maximum=None if "bounds" in self.lenient else maximum)

    def array(self, array: Array, path: wire.Path, field: Field) -> wire.Codec:
        plain = self.elements(array, path, field)
        headed = self.second and self.primitive_element(array) is None
        return self.sized(plain, path) if headed else plain

    def elements(self, array: Array, path: wire.Path, field: Field) -> wire.Codec:
        inner, field = array.element, replace(field, default=None)  # the default is that of the array
        if isinstance(inner, Array) and inner.fixed is not None and array.fixed is not None:
            item = self.elements(inner, (), field)  # the dimensions of one array
        else:
            item = self.value(inner, (), field) if not self.recurses(inner) else wire.Recursion((), _name(inner))
        if not isinstance(item, wire.Recursion) and recurses(item):
            raise SchemaError((words.nested_recursion(field.span, field.name),))
        if array.fixed is not None:
            repeat = wire.Repeat(path, wire.Count(None, value=array.fixed), item)
            return wire.Seq((wire.Align(leading(item)), repeat)) if array.fixed and leading(item) > 1 else repeat
        return self.counted(wire.Repeat(path, self.count(array.maximum), item, align=leading(item)))

    def recurses(self, type_: Type) -> bool:
        return isinstance(type_, Ref) and type_.name in self.recursive


def _extensibility(struct: Struct) -> str:
    """As the IDL says; idlc and rosidl take a struct for final where it does not."""
    found = struct.option("extensibility")
    return found if isinstance(found, str) else "final"


def _name(type_: Type) -> str:
    assert isinstance(type_, Ref)
    return type_.name
