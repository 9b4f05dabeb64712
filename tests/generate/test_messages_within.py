"""Messages of LCM and CDR within others of their type, which C++ reads and writes where the object has them."""

from __future__ import annotations

import random
import shutil
import struct
import subprocess
from functools import cache
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from tests.generate import cpp
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, same

LCM = """package t;
struct spot_t { double x; int16_t y; }
struct leaf_t { double xs[2]; spot_t spots[2]; string name; }
struct other_t { int32_t count; node_t back[count]; int8_t last; }
struct node_t {
  int32_t count; node_t nodes[count]; string name; int16_t many; int32_t numbers[many]; leaf_t leaves[many]; other_t others[many];
  int16_t last;
}
"""
IDL = """module t {
struct Node;
struct Leaf { double x; string name; };
struct Other { sequence<Node> back; octet last; };
struct Node { sequence<Node> nodes; string name; sequence<long> numbers; sequence<Leaf> leaves; sequence<Other> others; short last; };
};
"""
DEEPER = """#include HEADER
#include <cstdio>
int main()
{
    unit::codec codec;
    unit::holder around;
    around.count = 0;
    std::string bytes;
    for (int depth = 0; depth < 70; depth++) {
        const auto written = codec.try_encode(around, bytes);
        const auto size = codec.try_size(around);
        if (!written || !size) {
            std::printf("%d\\n%s\\n%s", depth, written.error().what().c_str(), size.error().what().c_str());
            return 0;
        }
        unit::holder another;
        another.count = 1;
        another.nodes.push_back(std::move(around));
        around = std::move(another);
    }
}
"""
CLAIMS = """#include HEADER
#include <cstdio>
#include <cstdlib>
#include <vector>
static std::size_t taken = 0;
void *operator new(std::size_t size)
{
    taken += size;
    if (void *const found = std::malloc(size)) {
        return found;
    }
    throw std::bad_alloc();
}
void operator delete(void *found) noexcept { std::free(found); }
void operator delete(void *found, std::size_t) noexcept { std::free(found); }
int main()
{
    std::vector<unsigned char> message;
    for (int byte = std::getchar(); byte != EOF; byte = std::getchar()) {
        message.push_back(static_cast<unsigned char>(byte));
    }
    unit::codec codec;
    unit::holder holder;
    taken = 0;
    const auto read = codec.try_decode(message.data(), message.size(), holder);
    std::printf("%s\\n%zu\\n", read ? "read" : read.error().what().c_str(), taken);
}
"""
NESTED = """package t;
struct nested_t { int32_t count; nested_t nodes[count]; }
"""
LARGE = """package t;
struct part_t { double x; double y; }
struct nested_t { part_t parts[500]; int32_t count; nested_t nodes[count]; }
"""
SCHEMAS = {
    "lcm": ("t.node_t", {"encoding": "lcm", "schema": {"t/x.lcm": LCM}}),
    "lcm of fixed lists": ("t.node_t", {"encoding": "lcm", "schema": {"t/x.lcm": LCM.replace("string name; }", "string names[2]; }")}}),
    "cdr": ("t::Node", {"encoding": "cdr", "schema": {"t.idl": IDL}}),
}


def node(chance: random.Random, depth: int, *, wide: bool) -> dict[str, object]:
    """A message with some within it, or with one within one within another."""
    nodes = [node(chance, depth - 1, wide=wide) for _ in range(chance.randrange(4) if wide else 1)] if depth else []
    many = chance.randrange(3) if wide else 0
    back = [[node(chance, depth - 1, wide=True)] if wide and depth and chance.random() < 0.3 else [] for _ in range(many)]
    text = "x" * chance.randrange(20)
    spots = [{"x": 0.5, "y": -many}, {"x": -3.0, "y": depth}]
    of_lcm = {"leaves": [{"xs": [1.5, -2.0], "spots": spots, "name": text}] * many, "count": len(nodes), "many": many}
    return of_lcm | {
        "nodes": nodes,
        "name": text,
        "numbers": [chance.randrange(1 << 31) for _ in range(many)],
        "others": [{"back": each, "count": len(each), "last": 5} for each in back],
        "last": -7,
    }


def as_lcm(value: dict[str, object], *, fixed: bool) -> dict[str, object]:
    """The same of LCM's type, whose leaves may have a list of two names."""
    nodes, others, leaves = value["nodes"], value["others"], value["leaves"]
    assert isinstance(nodes, list)
    assert isinstance(others, list)
    assert isinstance(leaves, list)
    named = [{"xs": each["xs"], "spots": each["spots"], "names": [each["name"], "b"]} if fixed else each for each in leaves]
    back = [{**each, "back": [as_lcm(inner, fixed=fixed) for inner in each["back"]]} for each in others]
    return {**value, "nodes": [as_lcm(each, fixed=fixed) for each in nodes], "leaves": named, "others": back}


def as_cdr(value: dict[str, object]) -> dict[str, object]:
    """The same without what CDR's type has not."""
    nodes, others = value["nodes"], value["others"]
    assert isinstance(nodes, list)
    assert isinstance(others, list)
    names = ("name", "numbers", "last")
    leaves = [{"x": 2.5, "name": "a leaf"}] * len(others)
    back = [{"back": [as_cdr(inner) for inner in each["back"]], "last": each["last"]} for each in others]
    return {name: value[name] for name in names} | {"nodes": [as_cdr(each) for each in nodes], "leaves": leaves, "others": back}


@pytest.fixture(scope="module")
def program_of(tmp_path_factory):
    """The source of a type in an encoding, the program around it, and the library's decoder and encoder."""

    @cache
    def made(encoding: str) -> tuple[str, Path, rj.Decoder, rj.Encoder]:
        (type_, options), folder = SCHEMAS[encoding], tmp_path_factory.mktemp("within")
        texts = generated(type_request("decode", type_, options), "cpp", BOTH, "unit", Wishes())
        program = cpp.program(folder, cpp.write(folder, texts), options=cpp.QUICK)
        return texts["unit.cpp"], program, rj.Decoder.of(type_, **options), rj.Encoder.of(type_, **options)

    return made


@cpp.needs_cpp
@pytest.mark.parametrize("encoding", SCHEMAS)
def test_messages_within_others(encoding, program_of):
    text, program, decode, encode = program_of(encoding)
    chance = random.Random(encoding)
    values = [node(chance, depth, wide=True) for depth in (0, 1, 4, 2, 0, 3)] + [node(chance, depth, wide=False) for depth in (63, 64)]
    fixed = encoding == "lcm of fixed lists"
    good = [bytes(encode(as_cdr(each) if encoding == "cdr" else as_lcm(each, fixed=fixed))) for each in values]
    deep = deeper(good[-1], encoding)
    messages = [*good, *harmed([each for each in good if len(each) < 3000], 30, encoding), deep, *good]
    assert "unit_nodes_objects::at(" in text
    assert "message_of(given_object.nodes," in text
    same(answers(program, messages), decode, encode, messages)


def deeper(message: bytes, encoding: str) -> bytes:
    """A message with one more level than are read: another one around all that are there."""
    if encoding != "cdr":
        return message[:8] + struct.pack(">i", 1) + message[8:] + struct.pack(">i", 1) + b"\0" + struct.pack(">hh", 0, 0)
    return message[:4] + struct.pack("<I", 1) + message[4:]


@cpp.needs_cpp
@pytest.mark.parametrize(("schema", "before"), [(NESTED, 0), (LARGE, 8000)], ids=["small", "large"])
def test_counts_that_a_message_only_says(schema, before, tmp_path):
    """Each of 64 messages within each other, small ones or large ones, says that all bytes behind it are elements of its list."""
    options: dict[str, object] = {"encoding": "lcm", "schema": {"t/x.lcm": schema}}
    size, each = (1 << 16) + 128 * before, before + 4
    encode = rj.Encoder.of("t.nested_t", **options)
    start = bytes(encode(encode.holder_type()))[:8]
    message = start + b"".join(bytes(before) + struct.pack(">i", size - each * level) for level in range(1, 65))
    message += bytes(8 + size - len(message))
    (tmp_path / "claims.cpp").write_text(CLAIMS)
    unit = cpp.write(tmp_path, generated(type_request("decode", "t.nested_t", options), "cpp", ("decode",), "unit", Wishes()))
    made = cpp.program(tmp_path, unit, options=cpp.QUICK, main=tmp_path / "claims.cpp")
    said, taken = subprocess.run([made], input=message, check=True, capture_output=True).stdout.decode().splitlines()
    with pytest.raises(rj.DecodeError) as error:
        rj.Decoder.of("t.nested_t", **options)(message)
    assert said.startswith(f"{error.value.kind} at {error.value.path}, byte {error.value.offset}: ")
    at_first = 64 * 2 * (1 << 16)  # of each level
    assert int(taken) < 128 * len(message) + at_first


@cpp.needs_cpp
def test_messages_that_have_none_within_them(tmp_path):
    """They are read in the header; where one has some, or anything is wrong with it, it is read anew."""
    options: dict[str, object] = {"encoding": "lcm", "schema": {"t/x.lcm": NESTED}}
    decode, encode = rj.Decoder.of("t.nested_t", **options), rj.Encoder.of("t.nested_t", **options)
    values = [{"count": count, "nodes": [{"count": 0, "nodes": []}] * count} for count in (2, 0, 0, 1, 3, 0)]
    good = [bytes(encode(each)) for each in values]
    messages = [*good, *harmed(good, 20, "none within"), *good]
    texts = generated(type_request("decode", "t.nested_t", options), "cpp", BOTH, "unit", Wishes())
    assert "resize_to(given_object.nodes, 0);" in texts["unit.hpp"]
    found = answers(cpp.program(tmp_path, cpp.write(tmp_path, texts), options=cpp.QUICK), messages)
    same(found, decode, encode, messages)


@cpp.needs_cpp
def test_a_list_that_becomes_long(program_of):
    """Lists of more messages than are made at first: all of them are read, in an object that has others from before."""
    _, program, decode, encode = program_of("lcm")
    leaf = node(random.Random(0), 0, wide=False)
    counts = (3, 1023, 1024, 1025, 5000, 2, 4097, 0)
    messages = [bytes(encode({**leaf, "nodes": [leaf] * count, "count": count})) for count in counts]
    same(answers(program, messages), decode, encode, messages)


@cpp.needs_cpp
def test_an_object_that_is_too_deep(tmp_path):
    """The depth is checked while an object is written, so that no further message is looked at."""
    type_, options = "t.nested_t", {"encoding": "lcm", "schema": {"t/x.lcm": NESTED}}
    (tmp_path / "deeper.cpp").write_text(DEEPER)
    unit = cpp.write(tmp_path, generated(type_request("encode", type_, options), "cpp", ("encode",), "unit", Wishes()))
    made = cpp.program(tmp_path, unit, options=cpp.QUICK, main=tmp_path / "deeper.cpp")
    said = subprocess.run([made], check=True, capture_output=True, text=True).stdout
    assert said.splitlines() == ["65", *["nesting at .nodes[].nodes: more than 64 structs within each other"] * 2]
    value: dict[str, object] = {"count": 0, "nodes": []}
    for _ in range(65):
        value = {"count": 1, "nodes": [value]}
    with pytest.raises(rj.EncodeError, match=r"nesting: .* `\.nodes\[\]\.nodes`"):
        rj.Encoder.of(type_, **options)(value)


ALIKE = "package t; struct node_t { int32_t count; node_t first[count]; node_t second[count]; }"


@cpp.needs_cpp
@pytest.mark.skipif(shutil.which("clang++") is None, reason="clang++ is not installed")
def test_arrays_one_behind_the_other(tmp_path):
    """Between them nothing is read, so that a state of the loop begins where the one before ends, which clang would complain of."""
    options = {"encoding": "lcm", "schema": {"t/x.lcm": ALIKE}}
    texts = generated(type_request("decode", "t.node_t", options), "cpp", BOTH, "unit", Wishes())
    cpp.compiled("clang++", tmp_path, cpp.write(tmp_path, texts))
