"""How LCM writes a message: the fingerprint, then the fields in order, big-endian, without padding. Arrays have no count of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.lcm import diagnostics as say
from rosetta_jit.frameworks.lcm.fingerprint import fingerprint
from rosetta_jit.frameworks.lcm.limits import MAX_DEPTH
from rosetta_jit.model import expr
from rosetta_jit.model.limits import MAX_SLOTS
from rosetta_jit.model.recursive_structs import recursive_structs
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Blob, Codec, Constant, Count, Encoding, Number, Path, Recursion, Repeat, Seq, Table
from rosetta_jit.wire.recursion import recurses

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Choices

STRING = Count("i32", ">")

ANY = 1 << 32
"""More bytes than any message has."""

BOOLEANS = ((0, 0), (1, 1))
"""What a boolean may be on the wire. A plain number is true if it is not 0."""


def encode_type(struct: Struct, schema: Schema, name: str, choices: Choices) -> Encoding:
    """The encoding of a message type.

    It can be lenient about ``bool`` (any number but 0 is true) and ``trailing`` (bytes behind the message), as LCM's own readers are.

    Raises
    ------
    SchemaError
        If structs contain each other too deep or too often.
    """
    writing = _Fields(schema, recursive_structs(Ref(struct.name), schema), strict="bool" not in choices.lenient)
    first = Constant((), fingerprint(struct, schema), "u64", ">")
    root = Seq((first, *writing.fields(struct, ())))
    nested = {each: Seq(writing.fields(schema.struct(each), ())) for each in sorted(writing.recursive)}
    spare = ANY if "trailing" in choices.lenient else 0
    return Encoding(name, (root,), root, nested=(nested,) if nested else (), spare=spare, forgivable=ANY)


@dataclass(slots=True)
class _Fields:
    """Codecs of fields. Paths start at the message, at an element of an array, or at a recursive struct."""

    schema: Schema
    recursive: frozenset[str]
    strict: bool
    made: int = 0

    def fields(self, struct: Struct, around: Path) -> tuple[Codec, ...]:
        self.made += len(struct.fields)
        if self.made > MAX_SLOTS:
            raise SchemaError((say.too_deep(struct.name, struct.span, MAX_DEPTH),))
        return tuple(self.field(each, around) for each in struct.fields)

    def field(self, field: Field, around: Path) -> Codec:
        codec = self.value(field.type, (*around, field.name), around)
        if isinstance(codec, Repeat) and recurses(codec.item) and not isinstance(codec.item, Recursion):
            raise SchemaError((say.recursion_in_elements(field.name, field.span),))
        return codec

    def value(self, type_: Type, path: Path, around: Path) -> Codec:
        """The codec of the value at a path; ``around`` is the path of the struct whose fields hold sizes."""
        match type_:
            case Int(bits, signed):
                return Number(path, f"{'i' if signed else 'u'}{bits}", ">")
            case Float(bits):
                return Number(path, f"f{bits}", ">")
            case Bool():
                return Table(path, "i8", BOOLEANS) if self.strict else Number(path, "i8")
            case String():
                return Blob(path, STRING, text=True, terminated=True)
            case Bytes(_, length):
                return Blob(path, _implied_count(length, around))
            case Array(element, length):
                return Repeat(path, _implied_count(length, around), self.value(element, (), around))
            case Enum():
                return Number(path, "i32", ">")
            case Ref(name) if name in self.recursive:
                return Recursion(path, name)
            case Ref(name):
                return self.value(self.schema.types[name], path, around)
            case Struct():
                return Seq(self.fields(type_, path))
            case Optional() | Map() | Union():
                raise AssertionError(type_)
            case _:
                assert_never(type_)


def _implied_count(length: int | expr.Expr | None, around: Path) -> Count:
    """The count that stands nowhere, but that the type or a field tells."""
    if isinstance(length, expr.Path):
        return Count(None, value=expr.Path("wire", (*map(expr.Member, around), *length.steps)))
    assert length is not None
    return Count(None, value=length)
