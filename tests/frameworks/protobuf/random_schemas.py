"""Random schemas of protobuf, and messages of them in all the ways in which fields may be written."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import random

INTEGERS = ["int32", "int64", "uint32", "uint64", "sint32", "sint64", "bool"]
FIXED = ["fixed32", "sfixed32", "float", "fixed64", "sfixed64", "double"]
KEYS = [*INTEGERS, "fixed32", "sfixed64", "string"]
TEXTS = [b"", b"x", "é€😀".encode(), b"\0", b"a" * 200]
NO_TEXTS = [b"\xff", b"\xc0\x80", b"\xed\xa0\x80"]
NUMBERS = [0, 1, 2, 5, 127, 128, 300, -1, -5, 1 << 31, (1 << 31) - 1, 1 << 32, 1 << 63, -(1 << 31)]
HEADS = ['syntax = "proto2";', 'syntax = "proto3";', 'edition = "2023";']
OPTIONAL = [["optional "], ["", "", "optional "], [""]]
"""What may stand before a single field, for each head."""
ENUM = "enum E { X = 0; Y = 1; Z = -5; W = 300; }"
MESSAGE_TYPES = ["A", "B", "C"]


class Declared(NamedTuple):
    """A field: its number, how it may come, and its type, or the types of key and value."""

    number: int
    label: str
    types: tuple[str, ...]


def declared(name: str, number: int, head: int, random_: random.Random) -> tuple[str, list[Declared]]:
    """A field as text, and what its messages may have."""
    type_ = random_.choice([*INTEGERS, *FIXED, "string", "bytes", "E", *MESSAGE_TYPES])
    optional = random_.choice(OPTIONAL[head])
    match random_.choice(["single", "single", "repeated", "map", "oneof", "group"]):
        case "map":
            types = (random_.choice(KEYS), random_.choice(["int32", "string", "double", "E", "B"]))
            return f"map<{types[0]}, {types[1]}> {name} = {number};", [Declared(number, "map", types)]
        case "repeated":
            is_number = type_ in INTEGERS or type_ in FIXED
            option = f" [packed = {random_.choice(['true', 'false'])}]" if is_number and head != 2 else ""
            return f"repeated {type_} {name} = {number}{option};", [Declared(number, "packed" if is_number else "single", (type_,))]
        case "oneof":
            cases = [Declared(number + at, "single", (random_.choice([type_, "string", "A", "E"]),)) for at in range(3)]
            fields = " ".join(f"{each.types[0]} {name}_{each.number} = {each.number};" for each in cases)
            return f"oneof {name} {{ {fields} }}", cases
        case "group" if head == 0:
            return f"{optional}group G{name} = {number} {{ optional int32 a0 = 1; }}", [Declared(number, "group", ("A",))]
        case _:
            return f"{optional}{type_} {name} = {number};", [Declared(number, "single", (type_,))]


def schema(random_: random.Random) -> tuple[str, dict[str, list[Declared]]]:
    head, texts, fields = random_.randrange(3), list[str](), dict[str, list[Declared]]()
    for name in MESSAGE_TYPES:
        number, lines, found = 0, list[str](), list[Declared]()
        for at in range(random_.randrange(2, 6)):
            number += random_.choice([3, 4, 14, 2_000, 100_000])
            line, own = declared(f"{name.lower()}{at}", number, head, random_)
            lines.append(line)
            found += own
        texts.append(f"message {name} {{ {' '.join(lines)} }}")
        fields[name] = found
    return f"{HEADS[head]} package t; {ENUM} {' '.join(texts)}", fields


class Writer:
    """Writes random messages of a schema."""

    def __init__(self, fields: dict[str, list[Declared]], random_: random.Random, *, pads: bool = True) -> None:
        self.fields, self.random = fields, random_
        self.least = [0] * 12 + [2, 3, 5, 6, 10] * pads
        """The least bytes that a varint takes."""

    def varint(self, value: int) -> bytes:
        """A varint, of more bytes than it needs now and then if the writer pads."""
        value &= (1 << 64) - 1
        parts = list[int]()
        least = self.random.choice(self.least)
        while value >= 128 or len(parts) < least - 1:
            parts.append(value & 127 | 128)
            value >>= 7
        return bytes([*parts, value])

    def value(self, type_: str, depth: int) -> tuple[int, bytes]:
        """A wire type, and the bytes behind the tag."""
        if type_ in FIXED:
            is_long = type_.endswith("64") or type_ == "double"
            numbers = [
                struct.pack("<d" if is_long else "<f", self.random.choice([1.5, -0.0, math.inf])),
                self.random.randbytes(8 if is_long else 4),
            ]
            return 1 if is_long else 5, self.random.choice(numbers)
        if type_ in ("string", "bytes"):
            data = self.random.choice([*TEXTS * 3, *NO_TEXTS])
        elif type_ in self.fields:
            data = self.message(type_, depth - 1)
        else:
            return 0, self.varint(self.random.choice([*NUMBERS, self.random.getrandbits(64)]))
        return 2, self.varint(len(data)) + data

    def entry(self, types: tuple[str, ...], depth: int) -> bytes:
        parts = list[bytes]()
        for _ in range(self.random.choice([0, 1, 2, 2, 2, 3])):
            number = self.random.randrange(2)
            wire, data = self.value(types[number], depth)
            parts.append(self.varint((number + 1) << 3 | wire) + data)
        return b"".join(parts)

    def packed(self, type_: str, depth: int) -> bytes:
        data = b"".join(self.value(type_, depth)[1] for _ in range(self.random.choice([0, 1, 2, 5])))
        return data[: len(data) - (not self.random.randrange(10))]

    def group(self, number: int, inside: bytes) -> bytes:
        return self.varint(number << 3 | 3) + inside + self.varint(self.random.choice([number] * 9 + [number + 1]) << 3 | 4)

    def field(self, name: str, depth: int) -> bytes:
        own = self.random.choice(self.fields[name])
        number, label = own.number, own.label
        if not self.random.randrange(12):
            number, label = self.random.choice([1, 7_777, 19_500, 536_870_911, own.number]), self.random.choice(["group", "single"])
            own = Declared(number, label, (self.random.choice(["int32", "fixed32", "double", "bytes"]),))
        if label == "map":
            data = self.entry(own.types, depth)
        elif label == "packed" and self.random.randrange(2):
            data = self.packed(own.types[0], depth)
        elif label == "group":
            return self.group(number, self.message("A", depth - 1))
        else:
            wire, data = self.value(own.types[0], depth)
            return self.varint(number << 3 | wire) + data
        return self.varint(number << 3 | 2) + self.varint(len(data)) + data

    def message(self, name: str, depth: int = 4) -> bytes:
        if depth <= 0:
            return b""
        data = b"".join(self.field(name, depth) for _ in range(self.random.choice([0, 1, 1, 2, 4])))
        return data if self.random.randrange(20) else data[: self.random.randrange(len(data) + 1)]
