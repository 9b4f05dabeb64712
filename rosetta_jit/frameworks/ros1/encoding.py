"""How ROS 1 writes a message: its fields one after another, little-endian, without padding (https://wiki.ros.org/msg).

Counts have 32 bits; an array of a fixed length has none, and an empty message no bytes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Blob, Codec, Count, Encoding, Number, Path, Repeat, Seq, Table

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Choices

BOOLEANS = ((0, 0), (1, 1))


def encode_type(struct: Struct, schema: Schema, name: str, choices: Choices) -> Encoding:
    """The encoding of a message type.

    Leniencies: ``bool`` takes every byte but 0 for true, as genpy does; ``text`` takes strings as they come, as roscpp does.
    """
    codec = _Messages(schema, choices.lenient).value(struct, ())
    return Encoding(name, (codec,), codec)


@dataclass(frozen=True, slots=True)
class _Messages:
    schema: Schema
    lenient: frozenset[str]

    def value(self, type_: Type, path: Path) -> Codec:
        resolved = self.schema.resolve(type_)
        match resolved:
            case Struct():
                return Seq(tuple(self.value(each.type, (*path, each.name)) for each in resolved.fields))
            case Array(element):
                return Repeat(path, _count(resolved), self.value(element, ()))
            case Bytes():
                return Blob(path, _count(resolved))
            case String(encoding, _, maximum):
                return Blob(path, Count("u32", maximum=maximum), text=encoding == "utf-8")
            case Bool():
                return Number(path, "bool") if "bool" in self.lenient else Table(path, "u8", BOOLEANS)
            case Int(bits, signed):
                return Number(path, f"{'i' if signed else 'u'}{bits}")
            case Float(bits):
                return Number(path, f"f{bits}")
            case Enum() | Union() | Optional() | Map() | Ref():
                raise AssertionError(type_)


def _count(sequence: Array | Bytes) -> Count:
    return Count("u32", maximum=sequence.maximum) if sequence.length is None else Count(None, value=sequence.length)
