"""Packed integers of protobuf in generated C++: many are read and written at once, and each as the library does it."""

from __future__ import annotations

import random
import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from rosetta_jit.generate.cpp.language import INCLUDE
from tests.generate import cpp, driver
from tests.generate.cpp import QUICK
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, same

SCALARS = ("int32", "int64", "uint32", "uint64", "sint32", "sint64", "bool", "Open")
FIELDS = "".join(f"repeated {scalar} f{number} = {number}; " for number, scalar in enumerate(SCALARS, 1))
SCHEMA = (
    'syntax = "proto3"; package t; enum Open { NONE = 0; SOME = 3; } '
    f"message N {{ repeated int64 f1 = 1; }} message M {{ {FIELDS} N n = 16; repeated N more = 17; "
    "repeated uint64 f9 = 9 [packed = false]; }"
)
OPTIONS = {"encoding": "protobuf", "schema": {"t.proto": SCHEMA}}
CPP = {"g++": QUICK, "g++ -O1": ("-O1", *QUICK[1:]), "g++ -U__SSE2__": ("-U__SSE2__", *QUICK), "clang++": ("-O2",)}
"""Options for C++. What an optimising compiler makes of it stays in the suite with clang++, what sanitizers find with g++.

Machines that look at sixteen bytes at once have code of their own; without the word for them it is what others have."""
WIDEST = 10
BEHIND_TAGS = len(SCALARS) + 1
"""The field whose integers come one by one."""


def varint(value: int, width: int = 0) -> bytes:
    """A varint, of ``width`` bytes where that is more than it needs."""
    written = bytearray()
    while value > 127 or len(written) + 1 < width:
        written.append(value & 127 | 128)
        value >>= 7
    return bytes([*written, value])


def of_width(chance: random.Random, width: int) -> bytes:
    """An integer whose varint has a number of bytes; rarely more than it needs, as no writer has it but all readers take it."""
    most = min(1 << 7 * width, 1 << 64)
    value = chance.randrange(most >> 7 if width > 1 else 0, most)
    return varint(value if chance.random() < 0.99 else 1, width)


def packed(chance: random.Random, field: int) -> bytes:
    """An array: its integers all have one width, or several that change from one to the next or after a while."""
    count, widest = chance.choice((0, 1, 3, 4, 5, 20, 64, 65, 130, 300)), chance.randint(1, WIDEST)
    match chance.randrange(4):
        case 0:
            widths = [widest] * count
        case 1:
            widths = [chance.randint(1, widest) for _ in range(count)]
        case 2:
            widths = [1 + (number // 30) % widest for number in range(count)]
        case _:
            widths = [chance.choice((1, 2)) for _ in range(count)]
    body = b"".join(of_width(chance, each) for each in widths)
    return varint(field << 3 | 2) + varint(len(body)) + body


def message(chance: random.Random) -> bytes:
    fields = [packed(chance, chance.randint(1, len(SCALARS))) for _ in range(chance.randint(1, 3))]
    inner = packed(chance, 1)
    nested = b"\x82\x01" + varint(len(inner)) + inner if chance.random() < 0.3 else b""
    another = b"\x8a\x01" + varint(len(inner)) + inner if chance.random() < 0.3 else b""
    return b"".join([*fields, nested, another, *([b"\xc0\x02\x05"] if chance.random() < 0.3 else [])])


COMPILERS = [
    "g++",
    pytest.param("g++ -O1", marks=pytest.mark.campaign),
    "g++ -U__SSE2__",
    pytest.param("clang++", marks=pytest.mark.campaign),
]
EVERY = [*COMPILERS, "gcc"]


@pytest.fixture(scope="module")
def program_by(tmp_path_factory):
    """The program that a compiler makes of the schema, which `gcc` does of C."""

    @cache
    def made(compiler: str) -> Path:
        command = compiler.split(maxsplit=1)[0]
        if shutil.which(command) is None:
            pytest.skip(f"{command} is not installed")
        folder, request = tmp_path_factory.mktemp("varints"), type_request("decode", "t.M", OPTIONS)
        if compiler == "gcc":
            return driver.driver(folder, driver.write(folder, generated(request, "c", BOTH, "unit")))
        name = cpp.write(folder, generated(request, "cpp", BOTH, "unit"))
        return cpp.program(folder, name, compiler=command, options=CPP[compiler])

    return made


def answer_alike(program: Path, messages: list[bytes], kinds: set[str]) -> None:
    """A program says of messages what the library does, and these kinds of things of some. Lanes of C have little room."""
    said = [(line, each) for line, each in zip(answers(program, messages), messages, strict=True) if not line.startswith("full ")]
    assert len(said) >= len(messages) // 4
    found, messages = [line for line, _ in said], [each for _, each in said]
    assert {line.split()[0] for line in found} >= kinds
    same(found, rj.Decoder.of("t.M", **OPTIONS), rj.Encoder.of("t.M", **OPTIONS), messages)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_arrays_of_all_widths_and_kinds(compiler, program_by):
    chance = random.Random(compiler)
    good = [message(chance) for _ in range(300)]
    answer_alike(program_by(compiler), [*good, *harmed(good[:100], 4, compiler)], {"ok", "truncated", "varint"})


def damaged(chance: random.Random, good: bytes, ways: int) -> Iterator[bytes]:
    """A message cut before each byte, and with each byte altered in some ways: integers end there, go on, or become too long."""
    for at, byte in enumerate(good):
        yield good[:at]
        for other in chance.sample((byte ^ 128, 128, 255, 0, 127, chance.randrange(256)), ways):
            yield good[:at] + bytes([other]) + good[at + 1 :]


def array_of(chance: random.Random, field: int, width: int) -> bytes:
    """An array whose integers have up to so many bytes, some of them more than they need. One of eleven bytes is none."""
    count, alike = chance.choice((1, 2, 7, 9, 20, 33, 66)), chance.random() < 0.4
    widths = [width if alike else chance.randint(1, width) for _ in range(count)]
    integers = [of_width(chance, each) if chance.random() < 0.8 else varint(chance.randrange(128), each) for each in widths]
    if chance.random() < 0.1:
        integers[chance.randrange(count)] = varint(chance.randrange(128), WIDEST + 1)
    if field == BEHIND_TAGS:
        return b"".join(varint(field << 3) + each for each in integers)
    body = b"".join(integers)
    return varint(field << 3 | 2) + varint(len(body)) + body


def check_damaged(program: Path, seed: int, ways: int, fields: Sequence[int]) -> None:
    chance = random.Random(seed)
    for field in fields:
        good = [array_of(chance, field, width) for width in range(1, WIDEST + 1)]
        answer_alike(program, [*good, *(each for one in good for each in damaged(chance, one, ways))], {"ok", "truncated"})


@pytest.mark.parametrize("compiler", EVERY)
def test_arrays_damaged_at_every_byte(compiler, program_by):
    """Of all widths, of two kinds of integers, bools, and integers behind tags."""
    check_damaged(program_by(compiler), [*CPP, "gcc"].index(compiler), 1, (2, 5, 7, BEHIND_TAGS))


@pytest.mark.campaign
@pytest.mark.parametrize("compiler", EVERY)
@pytest.mark.parametrize("seed", range(100, 125))
def test_arrays_damaged_at_every_byte_in_many_ways(compiler, seed, program_by):
    check_damaged(program_by(compiler), seed, 5, range(1, BEHIND_TAGS + 1))


def test_loops_are_recognised():
    """Each of the arrays is counted, read, measured and written by the functions of the shared header."""
    schema = f'syntax = "proto3"; package t; enum Open {{ NONE = 0; }} message A {{ {FIELDS} }}'
    request = type_request("decode", "t.A", {"encoding": "protobuf", "schema": {"t.proto": schema}})
    text = generated(request, "cpp", BOTH, "unit")["unit.cpp"]
    integers = len(SCALARS) - 1
    for function in ("count_of_varints", "read_varints", "size_of_varints", "write_varints"):
        assert text.count(f"detail::{function}(") == integers, function
    for function in ("count_of_flags", "read_flags_of_varints", "size_of_flags", "write_flags"):
        assert text.count(f"detail::{function}(") == 1, function
    for function in ("read_eight", "write_varint"):
        assert f"detail::{function}(" in text, function
    assert "borrow_read_eight(" not in text
    assert "varint_size(" not in text.replace("detail::varint_size(", "")
    assert not re.search("_of_varints|write_varints", generated(request, "c", BOTH, "unit")["unit.c"])


BORDERS = """
#include <rosetta_jit/rosetta_jit.hpp>
#include <vector>
using namespace rosetta_jit::detail;
static unsigned long long slow(unsigned char *to, std::uint64_t number) {
    unsigned long long size = 0;
    for (; number >= 128; number >>= 7) to[size++] = static_cast<unsigned char>(number | 128);
    to[size++] = static_cast<unsigned char>(number);
    return size;
}
int main() {
    std::vector<std::uint64_t> numbers;
    for (int bit = 0; bit < 64; bit++) {
        for (int more = -2; more < 3; more++) numbers.push_back((std::uint64_t{1} << bit) + static_cast<std::uint64_t>(more));
    }
    for (const std::uint64_t each : numbers) {
        unsigned char wanted[10] = {}, found[10] = {};
        const auto size = slow(wanted, each);
        if (varint_size(each) != static_cast<std::int64_t>(size)) return 1;
        if (write_varint(found, each) != varint_size(each) || std::memcmp(found, wanted, size) != 0) return 2;
        for (const std::uint64_t other : numbers) {
            unsigned char two[20] = {}, both[16] = {};
            const auto behind = slow(two, each), all = behind + slow(two + behind, other);
            if ((each | other) < std::uint64_t{1} << 42) {
                if (write_two_varints(both, each, other) != static_cast<std::int64_t>(all) || std::memcmp(both, two, all) != 0) return 3;
            }
            for (const std::int64_t count : {7, 8, 16, 19}) {
                std::int64_t number = 0;
                const std::int64_t seldom = (count + 2) / 3, often = count - seldom;
                const auto of_three = [&](std::int64_t which) { return which % 3 == 0 ? other : each; };
                const std::int64_t size_of_all = size_of_varints(number, count, of_three);
                if (number != count || size_of_all != often * varint_size(each) + seldom * varint_size(other)) return 7;
            }
        }
        if (each < 1u << 14 && (write_varint_of_two(found, each) != varint_size(each) || std::memcmp(found, wanted, size) != 0)) return 4;
        for (std::int64_t room = 0; room < 45; room++) { // no byte beyond the room, and all that fits
            std::vector<unsigned char> exact(static_cast<std::size_t>(room));
            std::int64_t number = 0;
            const std::int64_t at = write_varints(exact.data(), room, 0, number, 4, [&](std::int64_t) { return each; });
            if (number != std::min<std::int64_t>(4, room / varint_size(each)) || at != number * varint_size(each)) return 5;
            for (std::int64_t one = 0; one < number; one++) {
                if (std::memcmp(exact.data() + one * varint_size(each), wanted, size) != 0) return 6;
            }
        }
    }
    return 0;
}
"""


@cpp.needs_cpp
@pytest.mark.parametrize("compiler", ["g++ -O1", "g++ -U__SSE2__"])
def test_numbers_at_the_borders_of_all_widths(compiler, tmp_path):
    (tmp_path / "borders.cpp").write_text(BORDERS)
    subprocess.run(["g++", *cpp.STRICT, *CPP[compiler], f"-I{INCLUDE}", "borders.cpp", "-o", "borders"], cwd=tmp_path, check=True)
    subprocess.run([tmp_path / "borders"], check=True)
