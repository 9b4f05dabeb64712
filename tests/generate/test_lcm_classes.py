"""Classes as lcm-gen makes them: fixed arrays are arrays of C, but for those in arrays of another length; numbers are big-endian."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.errors import SchemaError
from rosetta_jit.generate.build import Wishes, generated
from tests.generate import cpp
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, CAREFUL, same

SCHEMA = {
    "rj/grid_t.lcm": """package rj;
struct grid_t {
    int64_t utime;
    double cells[2][3];
    int16_t six[6];
    float scale;
    int32_t rows;
    int32_t columns;
    float table[rows][columns];
    boolean known[columns];
    float pairs[columns][2];
}
struct empty_t { }
struct item_t { string name; int16_t three[3]; int32_t count; float many[count]; byte last; }
struct lists_t {
    int32_t rows;
    int32_t columns;
    rj.item_t items[rows];
    string names[columns];
    double table[rows][columns];
    rj.scale_t scales[columns];
    rj.empty_t none[rows];
    string words[rows][columns];
}
struct node_t { int32_t id; int32_t count; rj.node_t kids[count]; string name; }
struct forest_t { int32_t count; rj.node_t root; rj.node_t trees[count]; rj.node_t two[2]; rj.scale_t scale; }
struct scale_t { int16_t a; int32_t b; int64_t c; float d; double e; }
"""
}
HEADER = """#include <cstdint>
#include <string>
#include <vector>
namespace rj {
class grid_t {
public:
    std::int64_t utime; double cells[2][3]; std::int16_t six[6]; float scale; std::int32_t rows, columns;
    std::vector<std::vector<float>> table; std::vector<std::int8_t> known;
    std::vector<std::vector<float>> pairs;
};
class scale_t {
public:
    std::int16_t a; std::int32_t b; std::int64_t c; float d; double e;
};
class empty_t {};
class item_t {
public:
    std::string name; std::int16_t three[3]; std::int32_t count; std::vector<float> many; std::uint8_t last;
};
class lists_t {
public:
    std::int32_t rows, columns;
    std::vector<item_t> items; std::vector<std::string> names; std::vector<std::vector<double>> table;
    std::vector<scale_t> scales; std::vector<empty_t> none; std::vector<std::vector<std::string>> words;
};
class node_t {
public:
    std::int32_t id, count; std::vector<node_t> kids; std::string name;
};
class forest_t {
public:
    std::int32_t count; node_t root; std::vector<node_t> trees; node_t two[2]; scale_t scale;
};
}
"""


def compared(tmp_path, type_, values):
    options = {"encoding": "lcm", "schema": SCHEMA}
    (tmp_path / "rj_types.h").write_text(HEADER)
    texts = generated(type_request("decode", type_, options), "cpp", BOTH, "unit", Wishes(holder="lcm", include="rj_types.h"))
    name = cpp.write(tmp_path, texts)
    encode = rj.Encoder.of(type_, **options)
    good = [bytes(encode(each)) for each in values]
    messages = [message[:end] for message in good for end in range(len(message) + 1)] + harmed(good, 60, type_)
    same(answers(cpp.program(tmp_path, name, options=CAREFUL), messages), rj.Decoder.of(type_, **options), encode, messages)
    return texts


@cpp.needs_cpp
def test_arrays_of_arrays_are_read_and_written(tmp_path):
    grid = {"utime": -7, "cells": [[1.5, 2.0, -3.0], [0.0, 1e300, 4.0]], "six": [*range(-3, 3)], "scale": 0.5}
    known = {"rows": 2, "columns": 3, "table": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "known": [True, False, True]}
    known["pairs"] = [[0.5, each] for each in range(3)]
    compared(tmp_path, "rj.grid_t", [grid | known, grid | {"rows": 0, "columns": 0, "table": [], "known": [], "pairs": []}])


@cpp.needs_cpp
def test_numbers_are_read_and_written_in_the_header(tmp_path):
    texts = compared(tmp_path, "rj.scale_t", [{"a": -2, "b": 1 << 30, "c": -(1 << 60), "d": -0.5, "e": 1e-300}])
    assert all(f"rosetta_jit::detail::{each}_i16_be(" in texts["unit.hpp"] for each in ("load", "store"))


@cpp.needs_cpp
def test_lists_are_as_long_as_other_fields_say(tmp_path):
    """One object gets all messages: lists grow and shrink."""
    texts = compared(tmp_path, "rj.lists_t", [lists(*each) for each in ((2, 3), (0, 0), (5, 1), (1, 0), (0, 4), (3, 3))])
    for opened in ("items", "items_many", "table", "table_elements", "scales", "words"):
        assert f" {opened} = rosetta_jit::detail::opened(" in texts["unit.cpp"]


@cpp.needs_cpp
def test_a_member_whose_type_contains_itself(tmp_path):
    """`rj.forest_t` has a `node_t` as a member: of lcm-gen's classes those alone are never without it."""
    compared(tmp_path, "rj.forest_t", [forest(*each) for each in ((0, 0), (2, 1), (0, 3), (1, 2))])


def test_an_optional_member_whose_type_contains_itself_is_refused():
    """A class as of LCM cannot be without a member."""
    schema = 'syntax = "proto3"; package rj; message Node { repeated Node kids = 1; } message Tree { Node root = 1; }'
    request = type_request("decode", "rj.Tree", {"encoding": "protobuf", "schema": {"t.proto": schema}})
    with pytest.raises(SchemaError, match="classes of `lcm` have no fields as `root` \\(optional\\)"):
        generated(request, "cpp", BOTH, "unit", Wishes(holder="lcm", include="t.h"))


def forest(count, depth):
    node = {"id": -1, "count": 0, "kids": [], "name": "leaf"}
    for level in range(depth):
        node = {"id": level, "count": 2, "kids": [node, node | {"name": ""}], "name": "n" * 9 * level}
    scale = {"a": -2, "b": 1 << 30, "c": -(1 << 60), "d": -0.5, "e": 1e-300}
    return {"count": count, "root": node, "trees": [node] * count, "two": [node] * 2, "scale": scale}


def lists(rows, columns):
    scale = {"a": -2, "b": 1 << 30, "c": -(1 << 60), "d": -0.5, "e": 1e-300}
    words = [["w" * (row + each) for each in range(columns)] for row in range(rows)]
    item = [
        {"name": "n" * 9 * row, "three": [row, -1, 2], "count": row, "many": [0.5 * each for each in range(row)], "last": 255}
        for row in range(rows)
    ]
    told = {"rows": rows, "columns": columns, "items": item, "names": ["x" * 5 * each for each in range(columns)]}
    table = [[row + 0.25 * each for each in range(columns)] for row in range(rows)]
    return told | {"table": table, "scales": [scale] * columns, "none": [{}] * rows, "words": words}
