"""Arrays of bools, of which generated C++ reads many at once: of any length, and with a byte that is neither 0 nor 1 at any place."""

from __future__ import annotations

import shutil
import subprocess

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes, generated
from tests.generate import cpp
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, CAREFUL, QUICK, same

ROW = f"{'=' * 80}\nMSG: rj/Row\nbool[] flags\nint16 number\nbool[5] five\n"
SCHEMA = {"rj/msg/Message.msg": f"bool[] flags\nRow[] rows\nbool[9] nine\nuint8 last\n{ROW}"}
COUNTS = (0, 1, 7, 8, 9, 15, 31, 32, 33, 40, 71)
OF_BYTES = """#include <array>
#include <cstdint>
#include <vector>
namespace rj {
struct Row { std::vector<std::uint8_t> flags; std::int16_t number; std::array<std::uint8_t, 5> five; };
struct Message { std::vector<std::uint8_t> flags; std::vector<Row> rows; std::array<std::uint8_t, 9> nine; std::uint8_t last; };
}
"""
"""As roscpp has them."""


def read_alike(tmp_path, encoding, wishes=NO_WISHES, compiled=CAREFUL):
    """The source, when what it reads and writes has been compared with the library: messages cut at each byte, altered, and harmed."""
    options = {"encoding": encoding, "schema": SCHEMA}
    texts = generated(type_request("decode", "rj/Message", options), "cpp", BOTH, "unit", wishes)
    encode = rj.Encoder.of("rj/Message", **options)
    flags = {count: [each % 3 == 0 for each in range(count)] for count in COUNTS}
    row = {"flags": flags[9], "five": flags[15][:5]}
    values = [
        {"flags": each, "rows": [row | {"number": count}] * (count % 3), "nine": flags[9], "last": 7} for count, each in flags.items()
    ]
    good = [bytes(encode(each)) for each in values]
    messages = [message[:end] for message in good for end in range(len(message) + 1)]
    messages += [message[:at] + b"\2" + message[at + 1 :] for message in good for at in range(len(message))]
    messages += [each for message in good for each in harmed([message], 5, encoding)]
    name = cpp.write(tmp_path, texts)
    same(answers(cpp.program(tmp_path, name, options=compiled), messages), rj.Decoder.of("rj/Message", **options), encode, messages)
    return texts["unit.cpp"]


@cpp.needs_cpp
@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
def test_flags_come_out_the_same(encoding, tmp_path):
    text = read_alike(tmp_path, encoding)
    assert all(text.count(f"rosetta_jit::detail::{each}_flags") >= 2 for each in ("read", "copy"))


@cpp.needs_cpp
def test_bytes_of_a_class_are_set_where_they_are(tmp_path):
    (tmp_path / "rj_message.h").write_text(OF_BYTES)
    text = read_alike(tmp_path, "ros1", Wishes(holder="ros1", include="rj_message.h"))
    assert "flags = rosetta_jit::detail::sized<uint8_t>(given_object.flags, count);" in text
    assert "nine = rosetta_jit::detail::rows_of<uint8_t, 9>(given_object.nine);" in text


GRID = "package rj;\nstruct grid_t {\n  int8_t rows;\n  int8_t columns;\n  boolean first[rows];\n  boolean flags[rows][columns];\n}\n"


@cpp.needs_cpp
@pytest.mark.skipif(shutil.which("lcm-gen") is None, reason="lcm-gen is not installed")
def test_flags_of_lists_within_lists_are_read_several_at_once(tmp_path):
    options = {"encoding": "lcm", "schema": {"rj/grid_t.lcm": GRID}}
    texts = generated(type_request("decode", "rj.grid_t", options), "cpp", BOTH, "unit", Wishes(holder="lcm", include="rj/grid_t.hpp"))
    assert "rosetta_jit::detail::read_flags_of(flags_elements, 0, bytes + next, " in texts["unit.cpp"]
    (tmp_path / "grid_t.lcm").write_text(GRID)
    subprocess.run(["lcm-gen", "--cpp", "--cpp-hpath", tmp_path, tmp_path / "grid_t.lcm"], check=True)
    encode = rj.Encoder.of("rj.grid_t", **options)
    sizes = [(1, 1), (3, 4), (2, 7), (4, 8), (2, 33), (3, 3)]
    grids = [[[(row + column) % 3 == 0 for column in range(columns)] for row in range(rows)] for rows, columns in sizes]
    good = [bytes(encode({"rows": len(grid), "columns": len(grid[0]), "first": [True] * len(grid), "flags": grid})) for grid in grids]
    messages = [message[:end] for message in good for end in range(len(message) + 1)]
    messages += [message[:at] + b"\2" + message[at + 1 :] for message in good for at in range(len(message))]
    name = cpp.write(tmp_path, texts)
    same(answers(cpp.program(tmp_path, name, options=CAREFUL), messages), rj.Decoder.of("rj.grid_t", **options), encode, messages)


FEW_FLAGS = """#include <cstdint>
#include <vector>
namespace rj {
struct Message { std::vector<std::uint8_t> flags; std::vector<double> many; };
}
"""


@cpp.needs_cpp
def test_a_message_without_flags_is_read_in_the_header(tmp_path):
    (tmp_path / "rj_message.h").write_text(FEW_FLAGS)
    options = {"encoding": "ros1", "schema": {"rj/msg/Message.msg": "bool[] flags\nfloat64[] many\n"}}
    wishes = Wishes(holder="ros1", include="rj_message.h")
    texts = generated(type_request("decode", "rj/Message", options), "cpp", BOTH, "unit", wishes)
    assert "ROSETTA_JIT_INLINE static bool is_read_empty(" in texts["unit.hpp"]
    encode = rj.Encoder.of("rj/Message", **options)
    good = [bytes(encode({"flags": [True] * count, "many": [0.5] * count})) for count in (3, 0, 1, 0)]
    messages = [message[:end] + more for message in good for end in range(len(message) + 1) for more in (b"", b"\1")]
    name = cpp.write(tmp_path, texts)
    same(answers(cpp.program(tmp_path, name, options=CAREFUL), messages), rj.Decoder.of("rj/Message", **options), encode, messages)


OF_BITS = """#include <array>
#include <cstdint>
#include <vector>
namespace rj {
struct Row { std::vector<bool> flags; std::int16_t number; std::array<bool, 5> five; };
struct Message { std::vector<bool> flags; std::vector<Row> rows; bool nine[9]; std::uint8_t last; };
}
"""
"""As people have them."""


@cpp.needs_cpp
def test_bits_of_a_class_are_read_and_written(tmp_path):
    (tmp_path / "rj_message.h").write_text(OF_BITS)
    read_alike(tmp_path, "ros1", Wishes(holder="ros2", include="rj_message.h"), QUICK)


@cpp.needs_cpp
def test_bits_of_a_class_need_their_own_kind_of_classes(tmp_path):
    (tmp_path / "rj_message.h").write_text(OF_BITS)
    options = {"encoding": "ros1", "schema": SCHEMA}
    wishes = Wishes(holder="ros1", include="rj_message.h")
    cpp.write(tmp_path, generated(type_request("decode", "rj/Message", options), "cpp", BOTH, "unit", wishes))
    command = ["g++", "-std=c++17", "-fsyntax-only", "-I.", "unit.cpp"]
    found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "one whose arrays of bools are bool or std::vector<bool> is one as of `--holder ros2`" in found.stderr
