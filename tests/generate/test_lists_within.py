"""Lists within lists that generated C++ writes from where an object has them."""

from __future__ import annotations

import subprocess
from string import Template

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from rosetta_jit.generate.c.holder.within import Within, element_of
from rosetta_jit.kernel.nodes import Binary, Const, Get, Local, Place
from tests.generate import cpp
from tests.generate.cpp import CAREFUL, QUICK
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, LIBRARY, same

SEPARATOR = "=" * 80
TYPE = f"""Part[] parts
Part[2] pair
{SEPARATOR}
MSG: rj/Part
string name
Leaf[] leaves
Leaf[2] twins
string[] words
bool[] flags
Point[] points
int16[3] corner
{SEPARATOR}
MSG: rj/Leaf
string text
Point[] points
string[2] ends
float32[] weights
{SEPARATOR}
MSG: rj/Point
float64 x
float64 y
"""
LEAF = "struct Leaf { std::string text; %s<Point> points; std::array<std::string, 2> ends; std::vector<float> weights; };"
PART = """
struct Part {
    std::string name;
    std::vector<Leaf> leaves;
    std::array<Leaf, 2> twins;
    std::vector<std::string> words;
    %s flags;
    std::vector<Point> points;
    std::array<std::int16_t, 3> corner;
};
struct Parts { std::vector<Part> parts; std::array<Part, 2> pair; };
"""
HEADERS = {
    "alike": "struct Point { double x; double y; };" + LEAF % "std::vector" + PART % "std::vector<std::uint8_t>",
    "in another order": "struct Point { double y; double x; };" + LEAF % "std::vector" + PART % "std::vector<bool>",
    "not one behind the other": "struct Point { double x; double y; };" + LEAF % "std::deque" + PART % "std::vector<bool>",
}


def part(number: int) -> dict[str, object]:
    """One of many shapes."""
    points = [{"x": 0.5 * each, "y": -each} for each in range(number % 4)]
    leaf = {"text": "t" * number, "points": points, "ends": ["a" * number, "b"], "weights": [0.5] * (number % 3)}
    words = ["w" * 5 * each for each in range(number % 3)]
    known = {"flags": [each % 2 == 0 for each in range(3 * number)], "points": points[1:], "corner": [number, -1, 2]}
    return {"name": "n" * number, "leaves": [leaf] * (number % 5), "twins": [leaf, leaf | {"points": []}], "words": words} | known


def compared(tmp_path, encoding: str, wishes: Wishes, compiled: tuple[str, ...]) -> str:
    """The source file of a unit, whose program says what the library says."""
    options = {"encoding": encoding, "schema": TYPE}
    texts = generated(type_request("decode", "rj/Parts", options), "cpp", BOTH, "unit", wishes)
    decode, encode = (of("rj/Parts", **options) for of in (rj.Decoder.of, rj.Encoder.of))
    counts = (0, 3, 1, 7, 2)
    good = [bytes(encode({"parts": [*map(part, range(each))], "pair": [part(each), part(1)]})) for each in counts]
    messages = [*good, *harmed(good, 20, encoding), *good]
    same(answers(cpp.program(tmp_path, cpp.write(tmp_path, texts), options=compiled), messages), decode, encode, messages)
    return texts["unit.cpp"]


@cpp.needs_cpp
@pytest.mark.parametrize("encoding", ["ros1", pytest.param("cdr", marks=pytest.mark.campaign)])
def test_lists_within_lists_are_written_from_where_they_are(encoding, tmp_path):
    """No rows are made of them: structs, texts, and lists within those, of any length and of a fixed one."""
    text = compared(tmp_path, encoding, Wishes(), CAREFUL)
    for each in ("parts_leaves", "parts_twins", "parts_words", "parts_points", "parts_leaves_points", "parts_twins_points"):
        assert f"unit_{each}_row::list::at(" in text, each
    assert "rosetta_jit::detail::take" not in text


@cpp.needs_cpp
@pytest.mark.parametrize(
    "header", ["not one behind the other", *(pytest.param(each, marks=pytest.mark.campaign) for each in ("alike", "in another order"))]
)
def test_lists_of_any_class_are_written(header, tmp_path):
    """Elements may lie in memory in any way, bools, too."""
    declared = f"{LIBRARY}#include <array>\n#include <deque>\nnamespace rj {{\n{HEADERS[header]}\nnamespace msg = ::rj;\n}}\n"
    (tmp_path / "parts.h").write_text(declared)
    compared(tmp_path, "ros1", Wishes(holder="ros2", include="parts.h"), CAREFUL if header == "alike" else QUICK)


SCAN = f"""Beam[] beams
{SEPARATOR}
MSG: rj/Beam
string name
string[] labels
float32[] ranges
uint8[] echoes
int16[3] corner
Point[] points
{SEPARATOR}
MSG: rj/Point
float64 x
float64 y
"""
BEAM = Template(
    "struct Point { double x; double y; };"
    "struct Beam { std::string name; $list<std::string> labels; $list<float> ranges; $list<std::uint8_t> echoes;"
    " std::array<std::int16_t, 3> corner; $list<Point> points; };"
    "struct Scan { $list<Beam> beams; };"
)


def beam(number: int) -> dict[str, object]:
    """One with lists of so many elements."""
    points = [{"x": 0.5 * each, "y": -each} for each in range(number)]
    labels = ["a" * 9 * each for each in range(number)]
    lists = {"labels": labels, "ranges": [0.5] * number, "echoes": bytes(range(number)), "points": points}
    return {"name": "n" * number, "corner": [number, -1, 2], **lists}


def read_into(container: str, tmp_path) -> str:
    """The name of a unit that fills a class with such lists."""
    (tmp_path / "scan.h").write_text(
        f"{LIBRARY}#include <array>\n#include <deque>\n#include <list>\n"
        f"namespace rj {{\n{BEAM.substitute(list=f'std::{container}')}\nnamespace msg = ::rj;\n}}\n"
    )
    request = type_request("decode", "rj/Scan", {"encoding": "ros1", "schema": SCAN})
    return cpp.write(tmp_path, generated(request, "cpp", BOTH, "unit", Wishes(holder="ros2", include="scan.h")))


@cpp.needs_cpp
@pytest.mark.parametrize("container", ["deque", pytest.param("vector", marks=pytest.mark.campaign)])
def test_lists_are_read_where_their_elements_are_reached_by_an_index(container, tmp_path):
    """Whether they lie one behind the other or not."""
    program = cpp.program(tmp_path, read_into(container, tmp_path), options=CAREFUL if container == "vector" else QUICK)
    decode, encode = (of("rj/Scan", encoding="ros1", schema=SCAN) for of in (rj.Decoder.of, rj.Encoder.of))
    good = [bytes(encode({"beams": [*map(beam, range(each))]})) for each in (0, 3, 1, 20, 2)]
    messages = [*good, *harmed(good, 20, "ros1"), *good]
    same(answers(program, messages), decode, encode, messages)


@cpp.needs_cpp
def test_lists_that_no_index_reaches_are_not_read(tmp_path):
    """A compiler says so."""
    name = read_into("list", tmp_path)
    command = ["g++", "-std=c++17", "-fsyntax-only", f"-I{tmp_path}", tmp_path / f"{name}.cpp"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "the elements of a list must be reached by their index" in done.stderr


LIST = Within("view", 1, 8, frozenset({"start"}))
START, NUMBER = Local("i64", "start"), Local("i64", "number")
READ = Get("i64", Place(1, NUMBER, 8))


@pytest.mark.parametrize(
    ("row", "found"),
    [
        (START, (START, Const("i64", 0))),
        (Binary("add", START, NUMBER), (START, NUMBER)),
        (Binary("add", Binary("add", NUMBER, START), Const("i64", 2)), (START, Binary("add", NUMBER, Const("i64", 2)))),
        (READ, (READ, Const("i64", 0))),
        (Binary("add", READ, NUMBER), (READ, NUMBER)),
        (NUMBER, None),
        (Binary("sub", START, NUMBER), None),
        (Get("i64", Place(1, NUMBER, 16)), None),
    ],
)
def test_a_row_is_the_address_of_a_list_and_a_number(row, found):
    assert element_of(row, LIST) == found


def test_lists_of_pointers_become_rows():
    """A message of protoc's has pointers to its texts: they would be followed twice, to measure a message and to write it."""
    schema = 'syntax = "proto3"; package t; message L { repeated string texts = 1; } message M { repeated L more = 1; }'
    request = type_request("decode", "t.M", {"encoding": "protobuf", "schema": {"t.proto": schema}})
    for holder, reads in (("protobuf", False), ("own", True)):
        text = generated(request, "cpp", BOTH, "unit", Wishes(holder=holder))["unit.cpp"]
        assert ("_row::list::at(" in text) == reads


ALIKE = {
    "rj/piece_t.lcm": "package rj;\nstruct piece_t {\n  int8_t kind;\n  float corner[3];\n}\n",
    "rj/group_t.lcm": "package rj;\nstruct group_t {\n  string name;\n  int16_t count;\n  piece_t pieces[count];\n}\n",
    "rj/all_t.lcm": """package rj;
struct all_t {
  int32_t groups;
  group_t group[groups];
  int32_t count;
  piece_t pieces[count];
  string last;
}
""",
}
"""A kernel that measures has fewer locals than one that writes: those of one name have other values."""


@cpp.needs_cpp
def test_lists_are_found_by_the_locals_of_each_function(tmp_path):
    options = {"encoding": "lcm", "schema": ALIKE}
    texts = generated(type_request("decode", "rj.all_t", options), "cpp", BOTH, "unit")
    assert all(f"unit_{each}_row::list::at(" in texts["unit.cpp"] for each in ("group_pieces", "group_pieces_corner", "pieces_corner"))
    decode, encode = (of("rj.all_t", **options) for of in (rj.Decoder.of, rj.Encoder.of))
    pieces = [{"kind": each, "corner": [0.5 * each, 1.0, -each]} for each in range(4)]
    groups = [{"name": "n" * each, "count": each, "pieces": pieces[:each]} for each in range(4)]
    sizes = [(0, 0), (1, 0), (0, 1), (4, 3), (2, 2)]
    values = [
        {"groups": some, "group": groups[4 - some :], "count": count, "pieces": pieces[:count], "last": "end"} for some, count in sizes
    ]
    good = [bytes(encode(each)) for each in values]
    messages = [*good, *harmed(good, 20, "alike"), *(message[:end] for message in good for end in range(len(message))), *good]
    same(answers(cpp.program(tmp_path, cpp.write(tmp_path, texts), options=CAREFUL), messages), decode, encode, messages)
