"""Types that contain themselves in generated C++: messages of many rows, and fields behind those whose messages are written later."""

from __future__ import annotations

import random
import subprocess
from typing import TYPE_CHECKING

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from tests.generate import cpp, native
from tests.generate.cpp import QUICK, WATCHED
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, same

if TYPE_CHECKING:
    from collections.abc import Callable

ONE = """syntax = "proto3"; package t;
message M {
  repeated M kids = 1; int32 value = 2; string name = 3; repeated int64 many = 4; M last = 5; sint64 behind = 6; repeated bool flags = 7;
}
"""
SEVERAL = """syntax = "proto3"; package t;
message Pair { M first = 1; M second = 2; uint32 value = 3; }
message M {
  repeated M kids = 1; int32 value = 2; repeated Pair pairs = 3; map<string, M> named = 5;
  oneof kind { string text = 6; M only = 7; } sint64 behind = 8;
}
"""
TREE = """syntax = "proto3"; package t;
message Note { string text = 1; repeated int64 many = 2; }
message M { int32 value = 1; repeated int64 many = 2; Note note = 3; repeated M kids = 4; string behind = 5; }
"""
"""One field alone contains its type: the rows of its lane are the list of rows that are written."""
SMALL = 'syntax = "proto3"; package t; message M { repeated M kids = 1; M last = 2; }'
UNKNOWN = b"\xa0\x06\xac\x02"
DEEPER = """#include "unit.hpp"
#include <cstdio>
static std::string said(int depth, bool in_lists)
{
    unit::codec codec;
    unit::holder holder;
    auto *at = &holder;
    for (int number = 0; number < depth; number++) {
        if (in_lists) {
            at->kids.emplace_back();
            at = &at->kids.back();
        } else {
            at->last = std::make_unique<unit::M>();
            at = at->last.get();
        }
    }
    std::string bytes;
    const auto size = codec.try_size(holder);
    const auto written = codec.try_encode(holder, bytes);
    if (!size || !written) {
        return !size && !written && size.error().what() == written.error().what() ? size.error().what() : "other errors";
    }
    return *size == bytes.size() ? "written" : "another size";
}
int main()
{
    for (const int depth : {1, 1000, 1001, 30000}) {
        std::printf("%s\\n%s\\n", said(depth, false).c_str(), said(depth, true).c_str());
    }
}
"""

NAMED = 'syntax = "proto3"; package t; message M { int32 value = 1; string name = 2; repeated M kids = 3; }'
UNMEASURED = """#include "unit.hpp"
#include <cstdio>
int main()
{
    unit::codec first, second;
    unit::holder holder;
    holder.kids.resize(2);
    holder.kids[0].name = "one";
    holder.kids[1].kids.resize(1);
    holder.kids[1].kids[0].value = 300;
    unsigned char bytes[64];
    std::string again;
    const auto size = first.try_encode(holder, bytes, sizeof bytes);
    const bool same = size && second.try_encode(holder, again) && again == std::string(reinterpret_cast<char *>(bytes), *size);
    std::printf("%s\\n", same ? "the same" : "other bytes");
}
"""


def varint(value: int) -> bytes:
    return bytes([value]) if value < 128 else bytes([value & 127 | 128]) + varint(value >> 7)


def field(number: int, value: bytes | int) -> bytes:
    """A field, of bytes behind their length or of an integer."""
    tag = varint(number << 3 | (2 if isinstance(value, bytes) else 0))
    return tag + (varint(len(value)) + value if isinstance(value, bytes) else varint(value))


def integer(chance: random.Random) -> int:
    """One of one to nine bytes."""
    return chance.randrange(1, 1 << 7 * chance.choice((1, 1, 2, 2, 3, 5, 9)))


def one(chance: random.Random, depth: int) -> bytes:
    """A message of the first schema, in the order of its fields."""
    kids = b"".join(field(1, one(chance, depth - 1)) for _ in range(chance.randrange(4) if depth else 0))
    last = field(5, one(chance, depth - 1)) if depth and chance.random() < 0.5 else b""
    many = b"".join(varint(integer(chance)) for _ in range(chance.randrange(9)))
    own = field(2, chance.randrange(1, 1 << 31)) + field(3, b"x" * chance.randrange(1, 40)) + (field(4, many) if many else b"")
    flags = field(7, bytes([1, 0] * 20)[: chance.randrange(1, 40)]) if chance.random() < 0.5 else b""
    return kids + own + last + field(6, integer(chance)) + flags + (UNKNOWN if chance.random() < 0.2 else b"")


def several(chance: random.Random, depth: int) -> bytes:
    """One of the second."""
    inner = [several(chance, depth - 1) for _ in range(chance.randrange(5) if depth else 0)]
    pairs = (field(3, field(1, each) + field(2, each) + field(3, integer(chance) % (1 << 32) or 1)) for each in inner[:1])
    named = (field(5, field(1, b"key") + field(2, each)) for each in inner[1:2])
    kind = field(7, inner[2]) if len(inner) > 2 else field(6, b"text")
    parts = [*(field(1, each) for each in inner), field(2, chance.randrange(1, 1 << 31)), *pairs, *named, kind, field(8, integer(chance))]
    return b"".join(parts)


def tree(chance: random.Random, depth: int) -> bytes:
    """One of the third."""
    kids = b"".join(field(4, tree(chance, depth - 1)) for _ in range(chance.randrange(4) if depth else 0))
    many = [b"".join(varint(integer(chance)) for _ in range(chance.randrange(1, 9))) for _ in range(2)]
    note = field(3, field(1, b"y" * chance.randrange(1, 60)) + field(2, many[1])) if chance.random() < 0.5 else b""
    own = field(1, chance.randrange(1, 1 << 31)) + (field(2, many[0]) if chance.random() < 0.5 else b"")
    return own + note + kids + field(5, b"x" * chance.randrange(1, 40)) + (UNKNOWN if chance.random() < 0.2 else b"")


def of_random_fields(seed: str) -> tuple[str, Callable[[random.Random, int], bytes]]:
    """A schema whose one field of its own type stands anywhere among others, alone or many times or in a message of its own."""
    own = random.Random(seed)
    kinds = own.sample(["int32 {}", "repeated int64 {}", "string {}", "Note {}", "repeated Note {}", "double {}"], own.randint(1, 4))
    kinds.insert(own.randint(0, len(kinds)), own.choice(["repeated M {}", "M {}", "Box {}"]))
    fields = "".join(f"{kind.format(f'f{number}')} = {number}; " for number, kind in enumerate(kinds, 1))
    others = "message Note { string text = 1; } message Box { int32 n = 1; repeated M ms = 2; }"
    text = f'syntax = "proto3"; package t; {others} message M {{ {fields}}}'

    def value(kind: str, number: int, chance: random.Random, depth: int) -> bytes:
        within = range(chance.randrange(4) if depth else 0)
        match kind.removesuffix(" {}"):
            case "int32":
                return field(number, chance.randrange(1, 1 << 31))
            case "repeated int64":
                return field(number, b"".join(varint(integer(chance)) for _ in range(chance.randrange(1, 9))))
            case "string":
                return field(number, b"x" * chance.randrange(1, 40))
            case "Note" | "repeated Note" as note:
                several = range(chance.randrange(4) if note != "Note" else 1)
                return b"".join(field(number, field(1, b"y" * chance.randrange(1, 40))) for _ in several)
            case "double":
                return varint(number << 3 | 1) + b"\x00\x01\x02\x03\x04\x05\x06\x40"
            case "Box":
                return field(number, field(1, 5) + b"".join(field(2, made(chance, depth - 1)) for _ in within))
            case _ as child:
                return b"".join(field(number, made(chance, depth - 1)) for _ in (within if child != "M" else within[:1]))

    def made(chance: random.Random, depth: int) -> bytes:
        return b"".join(value(kind, number, chance, depth) for number, kind in enumerate(kinds, 1) if chance.random() < 0.8)

    return text, made


def deep(depth: int) -> bytes:
    """A message of the first schema, within which each has one: as many lengths are of more than a byte."""
    return (field(1, deep(depth - 1)) if depth else b"") + field(2, depth + 1) + field(3, b"x" * 300)


SCHEMAS = {"one": (ONE, one), "several": (SEVERAL, several), "tree": (TREE, tree)}
SCHEMAS |= {name: of_random_fields(name) for name in (f"random {seed}" for seed in range(6))}


def given(name: str) -> list[bytes]:
    """Messages of few rows, of many, and of few again; and harmed ones."""
    chance = random.Random(name)
    good = [SCHEMAS[name][1](chance, depth) for depth in (0, 1, 2, 5, 4, 1, 0, 3)]
    small = [each for each in good if len(each) < 2000]
    return [*good, *([deep(60), deep(3)] if name == "one" else []), *harmed(small, 20, name), *good]


@cpp.needs_cpp
@pytest.mark.parametrize("name", ["one", *(pytest.param(name, marks=pytest.mark.campaign) for name in SCHEMAS if name != "one")])
def test_classes_of_our_own(name, tmp_path):
    compare(name, cpp.program(tmp_path, written(tmp_path, name, Wishes()), options=QUICK))


@cpp.needs_cpp
@pytest.mark.parametrize("name", [pytest.param("one", marks=pytest.mark.campaign), "several", "tree"])
def test_classes_of_protoc(name, tmp_path):
    native.protoc(tmp_path, "t", SCHEMAS[name][0])
    unit = written(tmp_path, name, Wishes(holder="protobuf", include="t.pb.h"))
    compare(name, native.program_of_protoc(tmp_path, unit, "t", WATCHED))


@cpp.needs_cpp
def test_an_object_that_is_too_deep(tmp_path):
    """The stack has room for what is written by functions that call each other."""
    (tmp_path / "deeper.cpp").write_text(DEEPER)
    request = type_request("decode", "t.M", {"encoding": "protobuf", "schema": {"t.proto": SMALL}})
    unit = cpp.write(tmp_path, generated(request, "cpp", BOTH, "unit"))
    made = cpp.program(tmp_path, unit, options=QUICK, main=tmp_path / "deeper.cpp")
    found = subprocess.run([made], check=True, capture_output=True, text=True).stdout
    refused = "nesting: a message contains itself, or too many within each other"
    assert found.splitlines() == [*["written"] * 4, *[refused] * 4]


@cpp.needs_cpp
def test_an_object_that_nobody_has_measured(tmp_path):
    """A buffer that is given gets the bytes that a text does."""
    (tmp_path / "unmeasured.cpp").write_text(UNMEASURED)
    request = type_request("decode", "t.M", {"encoding": "protobuf", "schema": {"t.proto": NAMED}})
    unit = cpp.write(tmp_path, generated(request, "cpp", BOTH, "unit"))
    made = cpp.program(tmp_path, unit, options=QUICK, main=tmp_path / "unmeasured.cpp")
    assert subprocess.run([made], check=True, capture_output=True, text=True).stdout == "the same\n"


def options_of(name):
    return {"encoding": "protobuf", "schema": {"t.proto": SCHEMAS[name][0]}}


def written(folder, name, wishes):
    return cpp.write(folder, generated(type_request("decode", "t.M", options_of(name)), "cpp", BOTH, "unit", wishes))


def compare(name, program):
    """What a program says of messages is what the library says."""
    decode, encode = (of("t.M", **options_of(name)) for of in (rj.Decoder.of, rj.Encoder.of))
    same(answers(program, given(name)), decode, encode, given(name))
