"""Lists whose elements generated C++ sets where the object has them, as it reads them."""

from __future__ import annotations

import random
import subprocess
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from rosetta_jit.generate.c.holder.lanes import Straight
from rosetta_jit.generate.cpp.language import INCLUDE
from rosetta_jit.generate.cpp.passes.opened import in_place
from rosetta_jit.generate.passes.positions import difference
from rosetta_jit.kernel.ir import Kernel, Site
from rosetta_jit.kernel.nodes import Assign, Binary, Compare, Const, Expr, Fill, Get, If, Let, Local, Place, Return, SetField, Var
from rosetta_jit.kernel.walk import statements
from rosetta_jit.startup.dataclass import replace
from tests.generate import cpp
from tests.generate.cpp import CAREFUL, THOROUGH
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, LIBRARY, same

SEPARATOR = "=" * 80
TYPE = f"""Part[] parts
string name
string[] tags
{SEPARATOR}
MSG: rj/Part
int32 id
string name
Place place
Leaf[] leaves
bool ok
uint8[] blob
{SEPARATOR}
MSG: rj/Place
float64 x
float32 y
string frame
{SEPARATOR}
MSG: rj/Leaf
string text
int64 number
string[] words
float32[] weights
float64[3] corner
Pair[] pairs
Place[2] ends
string[2] both
{SEPARATOR}
MSG: rj/Pair
float64 x
float64 y
"""
CLASSES = """
struct Pair { double x; double y; };
%s double x; float y; std::string frame; };
%s std::string text; std::int64_t number; std::vector<std::string> words; std::vector<float> weights; std::array<double, 3> corner;
   std::vector<Pair> pairs; std::array<Place, 2> ends;
   std::array<std::string, 2> both; };
%s std::int32_t id; std::string name; Place place; std::vector<Leaf> leaves; bool ok; std::vector<std::uint8_t> blob; };
struct Parts { std::vector<Part> parts; std::string name; std::vector<std::string> tags; };
"""
NAMES = ("Place", "Leaf", "Part")
SKIPPING = "enum class Start { ALL, SKIP };\n" + CLASSES % tuple(
    f"struct {each} {{ explicit {each}(Start = Start::ALL) {{}}" for each in NAMES
)
HEADERS = {"plain": CLASSES % tuple(f"struct {each} {{" for each in NAMES), "made without values": SKIPPING}


def part(number: int) -> dict[str, object]:
    """One of many shapes."""
    text = "abcdefghijklmnopqrstuvwxyz" * 2
    leaves = [{"text": text[: 7 * each], "number": each - 2, "words": [text[:each]] * (each % 3)} for each in range(number % 5)]
    place = {"x": 0.5 * number, "y": -1.5, "frame": text[: number * 5 % 40]}
    for size, each in enumerate(leaves):
        each |= {"weights": [0.5 * size] * (2 * size % 5), "corner": [1.5, -size, number], "pairs": [{"x": size, "y": 0.5}] * (size % 3)}
        each["ends"], each["both"] = [place, {"frame": text[:size]}], [text[: 9 * size], "\u20ac"[size % 2 :]]
    return {"id": number, "name": text[:number], "place": place, "leaves": leaves, "ok": number % 2 == 0, "blob": bytes(number)}


@cpp.needs_cpp
@pytest.mark.parametrize(
    ("header", "encoding"),
    [
        ("plain", "cdr"),
        ("own", "ros1"),
        ("made without values", "cdr"),
        *(pytest.param(*each, marks=pytest.mark.campaign) for each in (("plain", "ros1"), ("own", "cdr"), ("made without values", "ros1"))),
    ],
)
def test_lists_within_lists_are_set_as_they_are_read(header, encoding, tmp_path):
    """One object gets all messages: lists grow and shrink, texts become longer and shorter; big-endian CDR, too."""
    options = {"encoding": encoding, "schema": TYPE}
    wishes = Wishes()
    if header != "own":
        (tmp_path / "parts.h").write_text(f"{LIBRARY}#include <array>\nnamespace rj {{\n{HEADERS[header]}\nnamespace msg = ::rj;\n}}\n")
        wishes = Wishes(holder="ros1", include="parts.h")
    name = cpp.write(tmp_path, generated(type_request("decode", "rj/Parts", options), "cpp", BOTH, "unit", wishes))
    text = (tmp_path / "unit.cpp").read_text()
    for opened in (
        "parts = rosetta_jit::detail::opened(given_object.parts",
        "parts_leaves = rosetta_jit::detail::opened(parts[i].leaves",
        "tags.put(",
        "parts_leaves_words.put(",
        "rosetta_jit::detail::assign(parts_leaves_both[",
        "weights = rosetta_jit::detail::opened(",
        "corner = rosetta_jit::detail::opened(",
        "pairs = rosetta_jit::detail::opened(",
        "ends = rosetta_jit::detail::opened(",
        "rosetta_jit::detail::copy_elements(parts_leaves_pairs, ",
    ):
        assert opened in text, opened
    decode, encode = (of("rj/Parts", **options) for of in (rj.Decoder.of, rj.Encoder.of))
    counts = (0, 3, 1, 12, 2, 0, 5)
    values = [
        {"parts": [part(each + count) for each in range(count)], "name": "n" * count, "tags": ["t" * count] * count} for count in counts
    ]
    good = [bytes(encode(each)) for each in values]
    messages = [*good, *harmed(good, 25, f"{header} {encoding}"), *good]
    compiled = THOROUGH if header == "plain" else CAREFUL
    same(answers(cpp.program(tmp_path, name, options=compiled), messages), decode, encode, messages)


@pytest.mark.parametrize("element", ["bool[4] flags", "bool[] flags"])
def test_a_list_is_opened_only_if_all_of_it_can_be(element):
    """Bools that are not a byte each keep rows, and what they are in does."""
    schema = TYPE.replace("int64 number\n", f"int64 number\n{element}\n")
    text = generated(type_request("decode", "rj/Parts", {"encoding": "ros1", "schema": schema}), "cpp", BOTH, "unit")["unit.cpp"]
    assert "opened_texts(given_object.tags" in text
    assert "opened(given_object.parts" not in text
    assert "resize_to(target.parts" in text


def test_lists_that_protobuf_writes_element_by_element_keep_rows():
    """It is not known how many follow. Their texts stay in the message until then."""
    schema = 'syntax = "proto3"; package t; message L { string text = 1; } message M { repeated L more = 1; repeated string texts = 2; }'
    request = type_request("decode", "t.M", {"encoding": "protobuf", "schema": {"t.proto": schema}})
    text = generated(request, "cpp", BOTH, "unit")["unit.cpp"]
    assert ".open(" not in text
    assert "::opened(" not in text
    assert ".text.count = (-1) - " in text


LIST, OPENED = Place(0, Const("i64", 0), 0), {(0, 0): Straight("", 1), (1, 0): Straight("")}
ROW, START = Local("i64", "row"), Local("i64", "start")
OPENS = (SetField(LIST, START), SetField(replace(LIST, offset=8), Const("i64", 3)))
SETS = SetField(Place(1, Binary("add", START, ROW), 0), Const("i64", 7))
END, EARLY = (Return(Const("i64", 0)),), (Return(Const("i64", 1)),)
SOME = Compare("lt", ROW, START)


@pytest.mark.parametrize(
    ("body", "is_in_place"),
    [
        ((*OPENS, SETS, *END), True),
        ((*OPENS, If(SOME, (SETS,), (SETS,)), *END), True),
        ((*OPENS, *END), False),
        ((SETS, *OPENS, *END), False),
        ((If(SOME, OPENS, ()), SETS, *END), False),
        ((*OPENS, SETS, If(SOME, (SetField(Place(1, ROW, 0), Const("i64", 7)),), ()), *END), False),
        ((*OPENS, SETS, Let("read", Get("i64", SETS.place)), *END), False),
        ((*OPENS, SETS, Fill(SETS.place, Const("i64", 8)), *END), False),
        ((*OPENS, SETS, SetField(replace(SETS.place, offset=8), Const("i64", 7)), *END), False),
        ((Var("start", Const("i64", 0)), *OPENS, Assign("start", ROW), SETS, *END), False),
        ((*OPENS, If(SOME, EARLY, ()), SETS, *END), True),
        ((If(SOME, EARLY, ()), *OPENS, SETS, *END), False),
    ],
)
def test_the_order_in_which_a_list_is_opened_and_set(body, is_in_place):
    """It must be open where its elements are set, whatever the message is; its rows are neither read nor cleared."""
    found = in_place(Kernel("t", "decode", (16, 16, 8), (body,), (Site("grow", "", ""),)), OPENED)
    assert (found is not None) == is_in_place
    if found is not None:
        assert SetField(Place(1, ROW, 0), Const("i64", 7)) in [stmt for stmt, _ in statements(found.bodies[0])]


ONE, OTHER = Local("i64", "one"), Local("i64", "other")


@pytest.mark.parametrize(
    ("sum_", "part_", "left"),
    [
        (Binary("add", ONE, OTHER), ONE, OTHER),
        (Binary("add", Binary("add", OTHER, Const("i64", 3)), ONE), ONE, Binary("add", OTHER, Const("i64", 3))),
        (ONE, ONE, Const("i64", 0)),
        (OTHER, Const("i64", 0), OTHER),
        (Binary("add", ONE, ONE), ONE, ONE),
        (OTHER, ONE, None),
        (ONE, Binary("add", ONE, ONE), None),
        (Binary("mul", ONE, OTHER), ONE, None),
    ],
)
def test_a_sum_without_a_part_of_it(sum_: Expr, part_: Expr, left: Expr | None):
    assert difference(sum_, part_) == left


TEXTS = """
#include <rosetta_jit/rosetta_jit.hpp>
#include <cstdio>
int main() {
    const std::string given = "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyz";
    const unsigned char *const bytes = reinterpret_cast<const unsigned char *>(given.data());
    for (std::size_t room = 0; room < 40; room += 13) {
        for (std::size_t before = 0; before < 40; before++) {
            for (std::size_t size = 0; size < 40; size++) {
                std::string text(before, 'x');
                text.reserve(room);
                rosetta_jit::detail::assign(text, bytes, static_cast<std::int64_t>(size));
                if (text != given.substr(0, size) || text.c_str()[size] != 0) { return 1; }
                text += "more";
                if (text != given.substr(0, size) + "more") { return 2; }
            }
        }
    }
    std::string text = "before";
    try {
        rosetta_jit::detail::assign(text, bytes, std::int64_t{1} << 62);
        return 3;
    } catch (const std::exception &) {
    }
    return text.empty() || text == "before" ? 0 : 4;
}
"""


@cpp.needs_cpp
def test_texts_are_set_whatever_a_string_has(tmp_path):
    """Of all lengths before and after, whether it has memory of its own or not; one that cannot be is empty, or as it was."""
    (tmp_path / "texts.cpp").write_text(TEXTS)
    subprocess.run(["g++", *cpp.STRICT, *THOROUGH, f"-I{INCLUDE}", "texts.cpp", "-o", "texts"], cwd=tmp_path, check=True)
    subprocess.run([tmp_path / "texts"], check=True)


IN_PLACE = ("int32", "float64", "bool", "string", "uint8[]", "float32[]", "float64[3]", "string[]", "int64[<=4]")
KINDS = (*IN_PLACE, "bool[]", "string[2]")
LEVELS = 4


def fields_of(chance: random.Random, level: int, *, is_opened: bool) -> list[tuple[str, str]]:
    """The fields of a type: numbers, texts, arrays, and types of the level below, alone and in lists, or those that are opened alone."""
    inner = [f"Level{level - 1}{each}" for each in ("", "[]", "[]", "[2]")] if level else []
    kinds = [chance.choice((*(IN_PLACE if is_opened else KINDS), *inner, *inner)) for _ in range(chance.randint(1, 5))]
    return [(f"f{number}", kind) for number, kind in enumerate(["string", *kinds] if is_opened else kinds)]


def value_of(chance: random.Random, types: dict[str, list[tuple[str, str]]], kind: str) -> object:
    name, _, size = kind.partition("[")
    if size:
        count = chance.randint(0, 4) if size[0] in "]<" else int(size[:-1])
        some = [value_of(chance, types, name) for _ in range(count)]
        return bytes(chance.randrange(256) for _ in some) if name == "uint8" else some
    match name:
        case "string":
            return "".join(chance.choice("abé") for _ in range(chance.choice((0, 3, 15, 16, 40))))
        case "bool":
            return chance.random() < 0.5
        case "float32" | "float64":
            return chance.randrange(-8, 8) / 4
        case "int32" | "int64" | "uint8":
            return chance.randrange(100)
        case _:
            return {field: value_of(chance, types, inner) for field, inner in types[name]}


def check_random(folder: Path, seed: int, compiled: tuple[str, ...] = THOROUGH) -> None:
    """Of a random type both encodings, in classes of our own."""
    chance = random.Random(seed)
    types = {f"Level{level}": fields_of(chance, level, is_opened=seed % 3 > 0) for level in range(LEVELS)}
    texts = {name: "".join(f"{kind} {field}\n" for field, kind in fields) for name, fields in types.items()}
    top = f"Level{LEVELS - 1}"
    schema = texts.pop(top) + "".join(f"{SEPARATOR}\nMSG: rj/{name}\n{text}" for name, text in texts.items())
    options_of = {each: {"encoding": each, "schema": schema.replace("<=4", "" if each == "ros1" else "<=4")} for each in ("ros1", "cdr")}
    units = {each: generated(type_request("decode", f"rj/{top}", options), "cpp", BOTH, each) for each, options in options_of.items()}
    program = cpp.program(folder, cpp.write_as_one(folder, "units", units.values()), options=compiled, units=units)
    for encoding, options in options_of.items():
        decode, encode = (of(f"rj/{top}", **options) for of in (rj.Decoder.of, rj.Encoder.of))
        good = [bytes(encode(value_of(chance, types, top))) for _ in range(12)]
        messages = [*good, *harmed(good, 12, str(seed)), *reversed(good)]
        same(answers(program, messages, unit=encoding), decode, encode, messages)


@cpp.needs_cpp
def test_a_random_type(tmp_path):
    check_random(tmp_path, 4, CAREFUL)


@pytest.mark.campaign
@cpp.needs_cpp
@pytest.mark.parametrize("seed", range(100, 140))
def test_random_types(seed, tmp_path):
    check_random(tmp_path, seed)
