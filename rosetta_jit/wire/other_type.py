"""Codecs of one type for holders of another: the same fields under other names, in another order, in integers of another size.

A codec names fields by their paths, and does not say where they lie. With other paths it fills another type, as long as that has a field
for each. What it has not, and need not have, is padding: any number is read, zero is written. What only the holder has may have to be zero
or empty: it is so where a message is read, and cannot be written with another value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from rosetta_jit.model.types import Array, Bool, Bytes, Float, Int, Schema, String, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.wire.codec import Align, Blob, Codec, Constant, Count, Encoding, Number, Padding, Path, Repeat, Seq, Table, Unsent


@dataclass(frozen=True, slots=True)
class Partners:
    """Of two structs: for each field of the one the field of the other that it is, None for none; and what is ``added`` in the other."""

    fields: Mapping[str, str | None]
    added: frozenset[str] = frozenset()


Pairs = Callable[[Struct, Struct, str], Partners]
"""For a struct of the wire, the holder's, and the path of both: which fields of the holder those of the wire are."""


OCTET = Int(8, signed=False, spelling="byte")
"""An element of `Bytes`."""


def is_same_word(one: Type, other: Type) -> bool:
    """Whether two types have one word for an integer whose sign they read differently, as ROS 1 and 2 for a `byte`: it is the same bits."""
    match one, other:
        case Int(bits, _, word), Int(other_bits, _, other_word):
            return word != "" and (bits, word) == (other_bits, other_word)
        case _:
            return False


class UnlikeError(Exception):
    """Two types that cannot stand for each other: ``path`` says where, ``why`` what differs."""

    def __init__(self, path: str, why: str) -> None:
        super().__init__(f"{path}: {why}")
        self.path, self.why = path, why


def for_other_type(encoding: Encoding, wire: Struct, holder: Struct, schema: Schema, pairs: Pairs) -> Encoding:
    """An encoding of ``wire`` that fills, or reads, holders of ``holder``.

    Raises
    ------
    UnlikeError
        A field has no partner, or one of another kind.
    """
    other = _OtherType(schema, pairs)
    codecs = tuple(other.whole(each, wire, holder, "") for each in encoding.attempts)
    written = encoding.written
    return replace(encoding, attempts=codecs, written=None if written is None else other.whole(written, wire, holder, ""))


@dataclass(frozen=True, slots=True)
class _Found:
    """A place of the holder, and what is there and on the wire."""

    path: Path
    wire: Type
    holder: Type
    shown: str


@dataclass(frozen=True, slots=True)
class _OtherType:
    schema: Schema
    pairs: Pairs

    def whole(self, codec: Codec, wire: Type, holder: Type, shown: str) -> Codec:
        """The codec of a message or an element, and behind it what is added in the holder."""
        found, unsent = self.codec(codec, wire, holder, shown), tuple(self.unsent(wire, holder, shown, ()))
        return Seq((found, *unsent)) if unsent else found

    def unsent(self, wire: Type, holder: Type, shown: str, path: Path) -> Iterator[Codec]:
        """The fields of the holder, at any depth, that are added to those of the wire."""
        one, other = self.schema.resolve(wire), self.schema.resolve(holder)
        if not isinstance(one, Struct) or not isinstance(other, Struct):
            return
        partners = self.pairs(one, other, shown)
        origins = {there: here for here, there in partners.fields.items() if there is not None}
        for each in other.fields:
            inside = (*path, each.name)
            if each.name in origins:
                yield from self.unsent(_field(one, origins[each.name]), each.type, f"{shown}.{each.name}", inside)
            elif each.name in partners.added:
                yield self.nothing(each.type, f"{shown}.{each.name}", inside)

    def nothing(self, type_: Type, shown: str, path: Path) -> Codec:
        """What takes no bytes, and is zero or empty."""
        match self.schema.resolve(type_):
            case Struct(_, fields):
                return Seq(tuple(self.nothing(each.type, f"{shown}.{each.name}", (*path, each.name)) for each in fields))
            case Array(element, length):
                count = length if isinstance(length, int) else 0
                return Repeat(path, Count(None, value=count), self.nothing(element, f"{shown}[]", ()) if count else Seq(()))
            case Bytes(_, length):
                return Blob(path, Count(None, value=length if isinstance(length, int) else 0))
            case String("utf-8" | "octets"):
                return Blob(path, Count(None, value=0))
            case Int(bits, signed):
                return Unsent(path, f"{'i' if signed else 'u'}{bits}")
            case Float(bits):
                return Unsent(path, f"f{bits}")
            case Bool():
                return Unsent(path, "bool")
            case _:
                raise UnlikeError(shown, "nothing of the message is called so")

    def codec(self, codec: Codec, wire: Type, holder: Type, shown: str) -> Codec:
        """The same codec with the paths of the holder."""
        match codec:
            case Seq(items):
                self.check(wire, holder, shown)
                return Seq(tuple(self.codec(each, wire, holder, shown) for each in items))
            case Align() | Padding():
                return codec
            case Repeat(path, _, item):
                found = self.find(path, wire, holder, shown)
                element = self.elements(found)
                return replace(codec, path=found.path, item=self.whole(item, *element, f"{found.shown}[]"))
            case Number(path, scalar, order):
                found = self.look(path, wire, holder, shown)
                if found is None:
                    return Padding(scalar, 0, order)
                there = self.scalar(found, scalar)
                if is_same_word(self.schema.resolve(found.wire), self.schema.resolve(found.holder)):
                    return replace(codec, path=found.path, scalar=there or scalar)
                return replace(codec, path=found.path, holder_scalar=there)
            case Blob(path) | Table(path) | Constant(path):
                found = self.find(path, wire, holder, shown)
                if path and type(self.schema.resolve(found.wire)) is not type(self.schema.resolve(found.holder)):
                    raise UnlikeError(found.shown, "is of another kind")
                return replace(codec, path=found.path)
            case _:
                raise UnlikeError(shown or ".", "messages of this encoding cannot be held in another type")

    def check(self, wire: Type, holder: Type, shown: str) -> None:
        """All fields of a struct have partners, also those that the wire leaves out."""
        one, other = self.schema.resolve(wire), self.schema.resolve(holder)
        if isinstance(one, Struct) and isinstance(other, Struct):
            self.pairs(one, other, shown)

    def find(self, path: Path, wire: Type, holder: Type, shown: str) -> _Found:
        found = self.look(path, wire, holder, shown)
        if found is None:
            raise UnlikeError("".join((shown, *(f".{name}" for name in path))), "the other type has no such field")
        return found

    def look(self, path: Path, wire: Type, holder: Type, shown: str) -> _Found | None:
        """The place of a field, None where the holder has none."""
        found = list[str]()
        for name in path:
            one, other = self.schema.resolve(wire), self.schema.resolve(holder)
            if not isinstance(one, Struct) or not isinstance(other, Struct):
                raise UnlikeError(shown or ".", "is a message in one type, and none in the other")
            partner = self.pairs(one, other, shown).fields[name]
            if partner is None:
                return None
            found.append(partner)
            wire, holder = _field(one, name), _field(other, partner)
            shown = f"{shown}.{name}"
        return _Found(tuple(found), wire, holder, shown)

    def elements(self, found: _Found) -> tuple[Type, Type]:
        one, other = self.schema.resolve(found.wire), self.schema.resolve(found.holder)
        if isinstance(other, Bytes):
            other = Array(OCTET, other.length)
        if not isinstance(one, Array) or not isinstance(other, Array) or one.length != other.length:
            raise UnlikeError(found.shown, "is an array in one type, and in the other none, or one of another length")
        return one.element, other.element

    def scalar(self, found: _Found, scalar: str) -> str | None:
        """The scalar that the holder has, if it is another one than the wire's."""
        match self.schema.resolve(found.holder):
            case Int(bits, signed) if scalar[0] in "iu":
                scalar_there = f"{'i' if signed else 'u'}{bits}"
                return None if scalar_there == scalar else scalar_there
            case Float(bits) if scalar == f"f{bits}":
                return None
            case Bool() if scalar == "bool":
                return None
            case _:
                raise UnlikeError(found.shown, "is of another kind")


def _field(struct: Struct, name: str) -> Type:
    return next(each.type for each in struct.fields if each.name == name)
