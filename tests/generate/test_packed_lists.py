"""Lists whose elements generated C++ copies from the message at once, where they lie so in the object."""

from __future__ import annotations

import re

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from tests.generate import cpp
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, CAREFUL, LIBRARY, QUICK, same

SEPARATOR = "=" * 80
TYPE = f"""Point[] points
Gap[] gaps
Line[] lines
Flag[] flags
Group[] groups
{SEPARATOR}
MSG: rj/Point
float32 x
float32 y
float32 z
{SEPARATOR}
MSG: rj/Gap
uint8 kind
float32 value
{SEPARATOR}
MSG: rj/Line
Point from
Point to
uint32 colour
{SEPARATOR}
MSG: rj/Flag
bool set
uint8[2] rest
{SEPARATOR}
MSG: rj/Group
string name
Point[] points
"""
OTHERS = """
struct Flag { std::uint8_t set = 0; std::array<std::uint8_t, 2> rest{}; };
struct Group { std::string name; std::vector<Point> points; };
struct Lists {
    std::vector<Point> points; std::vector<Gap> gaps; std::vector<Line> lines; std::vector<Flag> flags; std::vector<Group> groups;
};
"""
AS_THERE = """
struct Point { float x = 0, y = 0, z = 0; };
struct Gap { std::uint8_t kind = 0; float value = 0; };
struct Line { Point from, to; std::uint32_t colour = 0; };
"""
OTHERWISE = """
struct Point { float z = 0, y = 0, x = 0; };
struct Gap { float value = 0; std::uint8_t kind = 0; };
struct Line { Point to, from; std::int64_t colour = 0; };
"""
"""The fields in another order, and a wider one."""


def value(count: int) -> dict[str, object]:
    points = [{"x": each + 0.5, "y": -each, "z": 2.0 * each} for each in range(count)]
    return {
        "points": points,
        "gaps": [{"kind": each % 200, "value": 0.25 * each} for each in range(count + 1)],
        "lines": [{"from": one, "to": other, "colour": 7} for one, other in zip(points, points[::-1], strict=True)],
        "flags": [{"set": each % 2 == 0, "rest": bytes((each, 1))} for each in range(count % 3)],
        "groups": [{"name": "n" * each, "points": points[:each]} for each in range(count % 4)],
    }


@cpp.needs_cpp
@pytest.mark.parametrize("classes", [AS_THERE, OTHERWISE], ids=["as there", "otherwise"])
@pytest.mark.parametrize("encoding", ["ros1", pytest.param("cdr", marks=pytest.mark.campaign)])
def test_lists_come_out_the_same(encoding, classes, tmp_path):
    """One object gets all messages; whether elements are copied at once is what the compiler finds out of its class.

    Values that were copied into other fields would be copied back, so that only the compiler can tell.
    """
    options = {"encoding": encoding, "schema": TYPE}
    (tmp_path / "lists.h").write_text(f"{LIBRARY}#include <array>\nnamespace rj {{\n{classes}{OTHERS}\nnamespace msg = ::rj;\n}}\n")
    wishes = Wishes(holder="ros1", include="lists.h")
    name = cpp.write(tmp_path, generated(type_request("decode", "rj/Lists", options), "cpp", BOTH, "unit", wishes))
    asked = f"static_assert(unit::unit_points_in_message::lies<rj::Point>() == {str(classes == AS_THERE).lower()});\n"
    (tmp_path / f"{name}.cpp").write_text((tmp_path / f"{name}.cpp").read_text() + asked)
    decode, encode = (of("rj/Lists", **options) for of in (rj.Decoder.of, rj.Encoder.of))
    good = [bytes(encode(value(count))) for count in (0, 3, 1, 40, 2, 0, 5)]
    messages = [*good, *harmed(good, 20, encoding), *good]
    same(answers(cpp.program(tmp_path, name, options=CAREFUL if classes == AS_THERE else QUICK), messages), decode, encode, messages)


@pytest.mark.parametrize(("encoding", "gaps"), [("ros1", {"gaps"}), ("cdr", set())])
def test_only_numbers_without_gaps_in_the_message_are_copied(encoding, gaps):
    """CDR has gaps where numbers of four bytes follow one of a byte; a bool is looked at."""
    text = generated(type_request("decode", "rj/Lists", {"encoding": encoding, "schema": TYPE}), "cpp", BOTH, "unit")["unit.cpp"]
    assert set(re.findall(r"copy_elements\((\w+),", text)) == {"points", "lines", "groups_points", *gaps}
