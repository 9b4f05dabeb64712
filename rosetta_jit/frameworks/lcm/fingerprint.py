"""Fingerprints: the 64 bits before each message by which both ends know that they mean the same type (`lcmgen.c`).

A struct's own hash is made of its fields' names, primitive types and sizes; its fingerprint adds those of the structs in it, once for
each field, and rotates the sum. A struct that is met again inside itself adds 0. Names of structs do not matter; of enums, only they do.
"""

from __future__ import annotations

from collections import Counter

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.lcm import diagnostics as say
from rosetta_jit.frameworks.lcm.limits import MAX_DEPTH, MAX_WAYS
from rosetta_jit.frameworks.lcm.shape import shape_of, written_sizes
from rosetta_jit.model.recursive_structs import recursive_structs
from rosetta_jit.model.types import Enum, Field, Ref, Schema, Struct
from rosetta_jit.startup.dataclass import dataclass, field

MASK = (1 << 64) - 1
STRUCT_SEED, ENUM_SEED = 0x12345678, 0x87654321


def fingerprint(struct: Struct, schema: Schema) -> int:
    """The fingerprint of a type, as an unsigned number; raises SchemaError if structs contain each other too deep, or in too many ways."""
    return _Sums(schema, recursive_structs(Ref(struct.name), schema)).of(struct.name, frozenset())


def own_hash(struct: Struct) -> int:
    """The hash of a struct's own fields, without the structs in them."""
    value = STRUCT_SEED
    for each in struct.fields:
        shape = shape_of(each)
        value = _text(value, each.name)
        if shape.primitive:
            value = _text(value, shape.type)
        value = _step(value, len(shape.sizes))
        for size, text in zip(shape.sizes, written_sizes(each), strict=True):
            value = _text(_step(value, _mode(size)), text)
    return value & MASK


def enum_hash(name: str) -> int:
    """The fingerprint of an enum: its words may change."""
    return _text(ENUM_SEED, name.rpartition(".")[2]) & MASK


@dataclass(slots=True)
class _Sums:
    """Fingerprints below structs that are open: of those, only the recursive ones can be met again."""

    schema: Schema
    recursive: frozenset[str]
    known: dict[tuple[str, frozenset[str]], int] = field(default_factory=dict[tuple[str, frozenset[str]], int])
    parts: dict[str, tuple[int, Counter[str]]] = field(default_factory=dict[str, tuple[int, Counter[str]]])

    def of(self, name: str, open_: frozenset[str], depth: int = 0) -> int:
        declared = self.schema.types[name]
        if isinstance(declared, Enum):
            return enum_hash(name)
        if name in open_:
            return 0
        key = name, open_
        if key not in self.known:
            if depth == MAX_DEPTH or len(self.known) == MAX_WAYS:
                raise SchemaError((say.too_deep(declared.name, declared.span, MAX_DEPTH),))
            self.known[key] = self.sum(declared, open_ | {name} & self.recursive, depth)
        return self.known[key]

    def sum(self, struct: Struct, open_: frozenset[str], depth: int) -> int:
        if struct.name not in self.parts:
            self.parts[struct.name] = own_hash(struct), Counter(map(_declared, struct.fields))
        own, inside = self.parts[struct.name]
        total = own + sum(times * self.of(name, open_, depth + 1) for name, times in inside.items() if name)
        return _rotate(total & MASK)


def _declared(member: Field) -> str:
    """The struct or enum that a field is made of; empty where it is made of a primitive type."""
    shape = shape_of(member)
    return "" if shape.primitive else shape.type


def _mode(size: int | str) -> int:
    """How lcm-gen numbers constant and variable dimensions."""
    return int(isinstance(size, str))


def _text(value: int, text: str) -> int:
    value = _step(value, len(text))
    for char in text.encode():
        value = _step(value, char)
    return value


def _step(value: int, char: int) -> int:
    """C's ``((v << 8) ^ (v >> 55)) + c`` of a signed 64-bit number and a signed char."""
    return _signed((_signed(value << 8, 64) ^ (value >> 55)) + _signed(char, 8), 64)


def _signed(value: int, bits: int) -> int:
    value &= (1 << bits) - 1
    return value - (1 << bits) if value >> (bits - 1) else value


def _rotate(value: int) -> int:
    return (value << 1) & MASK | value >> 63
