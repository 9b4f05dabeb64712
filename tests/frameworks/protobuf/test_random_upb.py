"""Random schemas, and messages of them in all the ways in which fields may be written: upb reads and refuses what we read and refuse.

Left out is what docs/frameworks.md names as different: unknown fields within entries of maps, and strings of proto2 that are no text.
"""

from __future__ import annotations

import math
import random
import struct
from typing import NamedTuple

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import DecodeError
from grpc_tools import protoc

import rosetta_jit as rj

SCHEMAS, MESSAGES, CAMPAIGN = 2, 150, 400
INTEGERS = ["int32", "int64", "uint32", "uint64", "sint32", "sint64", "bool"]
FIXED = ["fixed32", "sfixed32", "float", "fixed64", "sfixed64", "double"]
KEYS = [*INTEGERS, "fixed32", "sfixed64", "string"]
TEXTS = [b"", b"x", "é€😀".encode(), b"\0", b"a" * 200]
NO_TEXTS = [b"\xff", b"\xc0\x80", b"\xed\xa0\x80"]
NUMBERS = [0, 1, 2, 5, 127, 128, 300, -1, -5, 1 << 31, (1 << 31) - 1, 1 << 32, 1 << 63, -(1 << 31)]
HEADS = ['syntax = "proto2";', 'syntax = "proto3";', 'edition = "2023";']
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
    optional = "optional " if head == 0 else ""
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

    def __init__(self, fields: dict[str, list[Declared]], random_: random.Random) -> None:
        self.fields, self.random = fields, random_

    def varint(self, value: int) -> bytes:
        """A varint, now and then of more bytes than it needs."""
        value &= (1 << 64) - 1
        parts = list[int]()
        least = self.random.choice([0] * 12 + [2, 3, 5, 6, 10])
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


def peer(text: str, folder):
    (folder / "a.proto").write_text(text)
    assert protoc.main(["protoc", f"-I{folder}", f"--descriptor_set_out={folder / 'set'}", "a.proto"]) == 0, text
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString((folder / "set").read_bytes()).file:
        pool.AddSerializedFile(file.SerializeToString())
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("t.A"))


def read_by_us(decode, message: bytes):
    """A holder, or None and the kind of the error."""
    try:
        return decode(message), ""
    except rj.DecodeError as error:
        return None, error.kind


def compare(seed: int, folder, backend: str = "llvm") -> int:
    """How many of the messages of a random schema both have read."""
    random_ = random.Random(f"upb {seed}")
    text, fields = schema(random_)
    options = {"schema": {"a.proto": text}, "imports": ["a.proto"], "encoding": "protobuf", "backend": backend}
    decode, encode, cls = rj.Decoder.of("t.A", **options), rj.Encoder.of("t.A", **options), peer(text, folder)
    writer, read = Writer(fields, random_), 0
    for _ in range(MESSAGES):
        message = writer.message("A")
        try:
            theirs = cls.FromString(message)
        except DecodeError:
            theirs = None
        ours, kind = read_by_us(decode, message)
        if ours is None:
            assert theirs is None or (kind == "text" and "proto2" in text), (text, message.hex(), kind)
            continue
        assert theirs is not None, (text, message.hex())
        back = cls.FromString(encode(ours))
        back.DiscardUnknownFields()
        theirs.DiscardUnknownFields()
        same = [each.SerializeToString(deterministic=True) for each in (back, theirs)]
        assert same[0] == same[1], (text, message.hex(), ours.to_dict(), str(theirs))
        read += 1
    return read


@pytest.mark.parametrize("seed", range(SCHEMAS))
def test_random_schemas(seed, tmp_path):
    assert compare(seed, tmp_path) > MESSAGES // 10


@pytest.mark.campaign
def test_many_random_schemas(tmp_path):
    assert sum(compare(seed, tmp_path) for seed in range(1_000, 1_000 + CAMPAIGN)) > CAMPAIGN * MESSAGES // 10
