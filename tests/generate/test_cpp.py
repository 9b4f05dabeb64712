"""Generated C++ does what the library does, with classes of its own and with those of frameworks."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import get_args

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of, type_request
from rosetta_jit.cli import main
from rosetta_jit.errors import Kind, SchemaError
from rosetta_jit.generate.build import Wishes, generated
from rosetta_jit.generate.c.words import RESERVED
from rosetta_jit.generate.cpp.language import INCLUDE, SHARED
from rosetta_jit.generate.cpp.objects.manners import MANNERS
from tests.generate import cpp, native
from tests.generate.corpora import corpora
from tests.generate.cpp import CAREFUL, QUICK, THOROUGH
from tests.generate.driver import answers, expected, harmed
from tests.generate.test_c import HOSTILE, SUBJECTS, TORSO, named
from tests.golden import GOLDEN, check_golden

BOTH = ("decode", "encode")
CMAKE = INCLUDE.parents[1] / "cmake"
HERE = Path(__file__).parent
NUMBERS = 'syntax = "proto2"; package rj; message Numbers { repeated double many = 1; optional double sometimes = 2; }'
OUTER = "=" * 80 + "\nMSG: evil/Inner\nfloat32 while\nstring memcpy\nuint8 holder\nint64[2] which\nstring codec\nbool[] std\n"
OUTER += "float64[] target\nint32 given_object\n"


def same(found: list[str], decode, encode, messages: list[bytes]) -> None:
    """What a program says is what the library says; entries of maps may come in another order."""
    assert len(found) == len(messages)
    for line, message in zip(found, messages, strict=True):
        wanted = expected(decode, encode, message)
        if line != wanted:
            if "memory than its size allows" in line:
                assert line.split("]")[0] == wanted.split("]")[0], (line, wanted)
                continue
            assert line.startswith("ok "), (line, wanted)
            assert wanted.startswith("ok "), (line, wanted)
            assert sorted(bytes.fromhex(line[3:])) == sorted(bytes.fromhex(wanted[3:])), message.hex()


@cpp.needs_cpp
def test_cpp_answers_as_the_library_does(tmp_path):
    """Built once as people do, with all warnings, and once with a sanitizer: strings, lists of strings, vectors of numbers."""
    request, good = SUBJECTS["joints"]
    name = cpp.write(tmp_path, generated(request, "cpp", BOTH, "joints"))
    messages = harmed(good, 12, name)
    found = answers(cpp.program(tmp_path, name, options=QUICK, is_apart=True), messages)
    assert {line.split()[0] for line in found} >= {"ok", "truncated"}
    same(found, rj.Decoder.of(request.type, encoding="ros1"), rj.Encoder.of(request.type, encoding="ros1"), messages)


LAID_OUT = {
    "alike": "struct Point { double x; double y; float weight; std::int32_t id; };",
    "in another order": "struct Point { std::int32_t id; float weight; double y; double x; };",
    "of other types": "struct Point { double x; double y; float weight; std::int64_t id; };",
    "with a member more": "struct Point { double x; double y; float weight; std::int32_t id; int own = 0; };",
    "with a destructor": "struct Point { ~Point() {} double x; double y; float weight; std::int32_t id; };",
}
POINTS = "Point[] points\nstring name\nWithin within\nName[] names\n" + "=" * 80 + "\nMSG: rj/Within\nPoint[] points\n" + "=" * 80
POINTS += "\nMSG: rj/Point\nfloat64 x\nfloat64 y\nfloat32 weight\nint32 id\n" + "=" * 80 + "\nMSG: rj/Name\nstring text\nint32 id\n"
LISTS = """
struct Name { std::string text; std::int32_t id; };
struct Within { std::vector<Point> points; };
struct Points { std::vector<Point> points; std::string name; Within within; std::vector<Name> names; };
"""
LIBRARY = "#pragma once\n#include <cstdint>\n#include <string>\n#include <vector>\n"
IN_MEMORY = [
    *((layout, "cdr") for layout in LAID_OUT),
    ("alike", "ros1"),
    *(pytest.param(layout, "ros1", marks=pytest.mark.campaign) for layout in LAID_OUT if layout != "alike"),
]
"""CDR, whose bytes come in both orders, sets numbers as ROS 1 does, too."""


@cpp.needs_cpp
@pytest.mark.parametrize(("layout", "encoding"), IN_MEMORY)
def test_lists_of_structs_however_their_class_lies_in_memory(layout, encoding, tmp_path):
    """Also of big-endian CDR, of which numbers are set one by one; texts in lists have all lengths that are copied in other ways."""
    (tmp_path / "points.h").write_text(f"{LIBRARY}namespace rj {{\n{LAID_OUT[layout]}\n{LISTS}namespace msg = ::rj;\n}}\n")
    options = {"encoding": encoding, "schema": POINTS}
    request = type_request("decode", "rj/Points", options)
    name = cpp.write(tmp_path, generated(request, "cpp", BOTH, "unit", Wishes(holder="ros1", include="points.h")))
    decode, encode = (of("rj/Points", **options) for of in (rj.Decoder.of, rj.Encoder.of))
    points = [{"x": 0.5 * i, "y": -float(i), "weight": 0.25 * i, "id": i - 2} for i in range(5)]
    names = [{"text": "abcdefghijklmnopqrstuvwxyz"[:i], "id": i} for i in range(20)]
    lists = {"points": points, "within": {"points": points[:2]}, "names": names}
    good = [bytes(encode({**each, "name": "n"})) for each in (lists, {**lists, "points": points[:1]}, {})]
    messages = harmed(good, 12, f"{layout} {encoding}")
    options = THOROUGH if layout == "alike" else QUICK
    same(answers(cpp.program(tmp_path, name, options=options), messages), decode, encode, messages)


@cpp.needs_cpp
def test_elements_that_lie_as_rows_do_are_not_copied_one_by_one(tmp_path):
    """The compiler finds it out, and that the others do not lie so."""
    (tmp_path / "points.h").write_text(f"{LIBRARY}namespace rj {{\n{LAID_OUT['alike']}\n{LISTS}}}\n")
    request = type_request("decode", "rj/Points", {"encoding": "ros1", "schema": POINTS})
    cpp.write(tmp_path, generated(request, "cpp", BOTH, "unit", Wishes(holder="ros1", include="points.h")))
    check = '#include "unit.cpp"\n'
    for layout, text in LAID_OUT.items():
        wanted, where = ("true" if layout == "alike" else "false"), layout.replace(" ", "_")
        check += f"namespace {where} {{ {text} }}\nstatic_assert(unit::unit_points_row::lies<{where}::Point>() == {wanted});\n"
    (tmp_path / "check.cpp").write_text(check)
    subprocess.run(["g++", "-std=c++17", "-fsyntax-only", f"-I{tmp_path}", tmp_path / "check.cpp"], check=True)


BOUNDED = """#pragma once
#include <cstdint>
#include <string>
#include <vector>
namespace rj {
/* Like rosidl's: data() cannot be called without the type of its elements. */
template <class Element> struct Bounded : protected std::vector<Element> {
    using Base = std::vector<Element>;
    using typename Base::value_type;
    using typename Base::allocator_type;
    using typename Base::iterator;
    using Base::begin;
    using Base::end;
    using Base::size;
    using Base::resize;
    using Base::operator[];
    template <class T> T *data() { return Base::data(); }
    template <class T> const T *data() const { return Base::data(); }
};
struct Point { double x; double y; float weight; std::int32_t id; };
struct Bounds {
    Bounded<std::uint8_t> bytes;
    Bounded<float> floats;
    Bounded<bool> bools;
    Bounded<std::string> texts;
    Bounded<Point> points;
};
}
"""
BOUNDS = "uint8[<=3] bytes\nfloat32[<=3] floats\nbool[<=3] bools\nstring[<=3] texts\nPoint[<=3] points\n" + "=" * 80
BOUNDS += "\nMSG: rj/Point\nfloat64 x\nfloat64 y\nfloat32 weight\nint32 id\n"


@cpp.needs_cpp
def test_vectors_with_a_bound_as_rosidl_has_them(tmp_path):
    """They do not show where their elements are."""
    (tmp_path / "bounds.h").write_text(BOUNDED.replace("namespace rj {", "namespace rj::msg {"))
    options = {"encoding": "cdr", "schema": BOUNDS}
    name = cpp.write(
        tmp_path, generated(type_request("decode", "rj/Bounds", options), "cpp", BOTH, "unit", Wishes(holder="ros2", include="bounds.h"))
    )
    decode, encode = (of("rj/Bounds", **options) for of in (rj.Decoder.of, rj.Encoder.of))
    points = [{"x": 0.5 * i, "y": -float(i), "weight": 0.25 * i, "id": i - 2} for i in range(3)]
    full = {"bytes": b"abc", "floats": [1.5, -2.5, 0.25], "bools": [True, False, True], "texts": ["a", "", "long"], "points": points}
    good = [bytes(encode(each)) for each in (full, {}, {**full, "bytes": b"", "points": points[:1]}, full)]
    messages = harmed(good, 12, "bounds")
    same(answers(cpp.program(tmp_path, name, options=QUICK), messages), decode, encode, messages)


TEXTS = f"{LIBRARY}namespace rj {{ struct Texts {{ std::vector<std::string> texts; std::string name; }}; namespace msg = ::rj; }}\n"


@cpp.needs_cpp
@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
def test_lists_of_texts_that_grow_and_shrink(encoding, tmp_path):
    """Those that an object has are set, and those that it lacks are made."""
    (tmp_path / "texts.h").write_text(TEXTS)
    options = {"encoding": encoding, "schema": "string[] texts\nstring name\n"}
    request = type_request("decode", "rj/Texts", options)
    name = cpp.write(tmp_path, generated(request, "cpp", BOTH, "unit", Wishes(holder="ros1", include="texts.h")))
    assert "opened_texts(given_object.texts" in (tmp_path / "unit.cpp").read_text()
    decode, encode = (of("rj/Texts", **options) for of in (rj.Decoder.of, rj.Encoder.of))
    texts = ["abcdefghijklmnopqrstuvwxyz"[: 3 * each % 27] for each in range(40)]
    good = [bytes(encode({"texts": texts[:count], "name": "n"})) for count in (0, 3, 1, 40, 2, 2, 7, 0, 12)]
    messages = [*good, *harmed(good, 12, encoding), *good]
    same(answers(cpp.program(tmp_path, name, options=CAREFUL), messages), decode, encode, messages)


FEW = """
#include <rosetta_jit/rosetta_jit.hpp>
using namespace rosetta_jit::detail;
int main() {
    unsigned char given[128];
    for (int at = 0; at < 128; at++) { given[at] = static_cast<unsigned char>(at % 3 == 0 ? 0 : at); }
    for (int size = 0; size < 100; size++) {
        unsigned char filled[128] = {}, copied[128] = {}, numbers[128] = {}, flags[128];
        std::memset(flags, 255, sizeof flags);
        fill_few(filled, 3, size, 255);
        copy_few(copied, 3, given, 5, size);
        copy_numbers(numbers, 3, given, 5, size);
        copy_flags(flags + 3, given + 5, size);
        for (int at = 0; at < 128; at++) {
            const bool is_within = at >= 3 && at < 3 + size;
            const int expected = is_within ? given[at + 2] : 0;
            if (filled[at] != (is_within ? 255 : 0) || copied[at] != expected || numbers[at] != expected) { return 1; }
            if (flags[at] != (!is_within ? 255 : expected != 0 ? 1 : 0)) { return 2; }
        }
    }
    for (int size = 0; size < 300; size++) {
        std::vector<unsigned char> text(static_cast<std::size_t>(size), 'a'); /* of which no byte may be read that it does not have */
        if (!is_ascii(text.data(), 0, size)) { return 3; }
        for (unsigned char &each : text) {
            each = 200;
            if (is_ascii(text.data(), 0, size)) { return 4; }
            each = 'a';
        }
    }
}
"""


@cpp.needs_cpp
def test_few_bytes_are_filled_and_copied(tmp_path):
    """Of each size all of them, and none beside."""
    (tmp_path / "few.cpp").write_text(FEW)
    subprocess.run(["g++", *cpp.STRICT, *QUICK, f"-I{INCLUDE}", tmp_path / "few.cpp", "-o", tmp_path / "few"], check=True)
    subprocess.run([tmp_path / "few"], check=True)


@cpp.needs_cpp
@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_no_compiler_complains_of_a_hostile_schema(tmp_path, compiler):
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    request = type_request("decode", "evil/Outer", {"encoding": "ros1", "schema": HOSTILE + OUTER})
    name = cpp.write(tmp_path, generated(request, "cpp", BOTH, "evil"))
    subprocess.run([compiler, *cpp.STRICT, "-fsyntax-only", f"-I{tmp_path}", tmp_path / f"{name}.cpp"], check=True)


WITHOUT_EXCEPTIONS = """
#include "torso.hpp"
int main()
{
    torso::codec codec;
    torso::JointAngles angles;
    const auto read = codec.try_decode("", 0, angles);
    return read ? 1 : read.error().offset == 0 ? 0 : 2;
}
"""


@cpp.needs_cpp
@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_programs_may_disable_exceptions(compiler, tmp_path):
    """And type information."""
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    name = cpp.write(tmp_path, generated(TORSO, "cpp", BOTH, "torso"))
    (tmp_path / "main.cpp").write_text(WITHOUT_EXCEPTIONS)
    options = ("-fno-exceptions", "-fno-rtti")
    made = cpp.program(tmp_path, name, compiler=compiler, options=options, main=tmp_path / "main.cpp", is_apart=True)
    assert subprocess.run([made], check=False).returncode == 0


@cpp.needs_cpp
@pytest.mark.parametrize("kind", ["int32", "string", "Inner", "Inner[]", "string[]", "float32[2]"])
def test_fields_are_called_as_the_unit_calls_its_own(tmp_path, kind):
    name = cpp.write(tmp_path, generated(named(kind), "cpp", BOTH, "evil"))
    subprocess.run(["g++", *cpp.STRICT, "-fsyntax-only", f"-I{tmp_path}", tmp_path / f"{name}.cpp"], check=True)


@cpp.needs_cpp
def test_types_are_called_as_the_unit_calls_its_own(tmp_path):
    names = ["fill", "gather", "source", "report", "decode_message", "borrow_sites", "ROSETTA_JIT_INLINE", "EVIL_HPP", "written"]
    fields = "\n".join(f"{name} one_{name}\n{name}[] more_{name}" for name in names)
    inner = "".join(f"===\nMSG: evil/{name}\nint16 x\nstring y\n" for name in names)
    request = type_request("decode", "evil/Outer", {"encoding": "ros1", "schema": f"{fields}\n{inner}"})
    name = cpp.write(tmp_path, generated(request, "cpp", BOTH, "evil"))
    subprocess.run(["g++", *cpp.STRICT, "-fsyntax-only", f"-I{tmp_path}", tmp_path / f"{name}.cpp"], check=True)


@pytest.mark.parametrize("end", ["hpp", "cpp"])
def test_the_text_is_the_same_every_time(end):
    texts = generated(TORSO, "cpp", BOTH, "torso_state", Wishes(holder="protobuf"))
    check_golden(GOLDEN / "generate" / f"torso_state.{end}", texts[f"torso_state.{end}"])


def test_numbers_are_set_where_the_object_has_them():
    """No row keeps the numbers that every message has: neither of them is copied twice. A number that may be absent is."""
    request = type_request("decode", "sensor_msgs/msg/Imu", {"encoding": "cdr"})
    text = generated(request, "cpp", BOTH, "imu", Wishes(holder="ros2"))["imu.cpp"]
    assert "    rosetta_jit::detail::set(given_object.orientation.x, load_f64_le(bytes + at_2));\n" in text
    assert "row.orientation.x);" not in text
    request = type_request("decode", "rj.Numbers", {"encoding": "protobuf", "schema": NUMBERS})
    text = generated(request, "cpp", BOTH, "numbers", Wishes(holder="protobuf"))["numbers.cpp"]
    assert "set_sometimes(rosetta_jit::detail::as<decltype(target.sometimes())>(row.sometimes));" in text


@pytest.mark.parametrize("language", ["c", "cpp"])
def test_positions_that_a_loop_proves_are_not_checked_again(language):
    request = type_request("decode", "rj.Numbers", {"encoding": "protobuf", "schema": NUMBERS})
    text = generated(request, language, BOTH, "numbers")[f"numbers.{language}"]
    assert re.search(r"if \(end < next_2 \+ 8\) \{\n +failure->indices\[0\] = many_used - ", text)
    assert re.search(r"if \(many_used >= holder->many.capacity\) \{", text)


@pytest.mark.campaign
@cpp.needs_cpp
@pytest.mark.parametrize(("holder", "type_"), native.NATIVE, ids=lambda each: each)
def test_the_classes_of_frameworks(holder, type_, tmp_path):
    """Classes that the frameworks' own generators made."""
    corpus = next(each for each in corpora() if each.name == f"{holder} {type_}")
    options, include = native.OF[holder](type_, tmp_path)
    name = cpp.write(tmp_path, generated(corpus.request, "cpp", BOTH, "unit", Wishes(holder=holder, include=include)))
    rounds = 0 if type_ == "rj3.All" else 12  # unknown fields with needlessly long tags get short ones from protobuf
    messages = harmed(list(corpus.messages), rounds, type_)
    same(answers(cpp.program(tmp_path, name, *options), messages), *corpus.programs(), messages)


@pytest.mark.campaign
@cpp.needs_cpp
@pytest.mark.parametrize("corpus", corpora(), ids=lambda each: each.name)
def test_messages_of_peers(corpus, tmp_path):
    name = cpp.write(tmp_path, generated(corpus.request, "cpp", BOTH, "unit"))
    messages = harmed(list(corpus.messages), 4, corpus.name)
    same(answers(cpp.program(tmp_path, name, options=QUICK), messages), *corpus.programs(), messages)


def test_the_shared_header_has_the_version_and_all_kinds_of_errors():
    text = (INCLUDE / SHARED).read_text()
    assert f'#define ROSETTA_JIT_VERSION "{rj.__version__}"' in text
    for number, part in zip(rj.__version__.split("."), ("MAJOR", "MINOR", "PATCH"), strict=False):
        assert f"ROSETTA_JIT_VERSION_{part} " in text, number
    assert f'set(PACKAGE_VERSION "{rj.__version__}")' in (CMAKE / "rosetta_jitConfigVersion.cmake").read_text()
    for kind in get_args(Kind):
        assert f'case status::{kind}{"_" if kind in RESERVED else ""}:\n        return "{kind}";' in text


def test_no_namespace_is_called_as_a_class():
    """One that is in no namespace itself, as the types of LCM's own programs are."""
    request = type_request("decode", "channel_port_map_update_t", {"encoding": "lcm"})
    for name in ("channel_port_map_update_t", "channel_to_port_t"):
        with pytest.raises(SchemaError, match="unusable-name"):
            generated(request, "cpp", BOTH, name, Wishes(holder="lcm"))
        assert generated(request, "cpp", BOTH, name)
    assert generated(request, "cpp", BOTH, "update", Wishes(holder="lcm"))


def test_classes_without_such_fields_are_refused():
    request = type_request("decode", "rst.vision.Image", {"encoding": "protobuf"})
    with pytest.raises(SchemaError, match="not-in-holder"):
        generated(request, "cpp", BOTH, "image", Wishes(holder="ros1", include="image.h"))


OTHERS = {
    ("std_msgs/Header", "ros1"): {"ros2", "lcm", "protobuf", "rsb"},
    ("std_msgs/Header", "cdr"): {"ros1", "lcm", "protobuf", "rsb"},
    ("exlcm.example_t", "lcm"): {"ros1", "ros2", "protobuf", "rsb"},
    ("rst.kinematics.JointAngles", "protobuf"): {"ros1", "ros2", "lcm"},
}
"""Types, and the frameworks' classes that they do not have."""


@pytest.mark.parametrize(("type_", "encoding"), OTHERS)
def test_types_have_classes_of_their_own_framework(type_, encoding):
    """Who names a header has such a class."""
    request = type_request("decode", type_, {"encoding": encoding})
    for manners in MANNERS:
        if manners.name not in OTHERS[type_, encoding]:
            assert generated(request, "cpp", BOTH, "unit", Wishes(holder=manners.name))
            continue
        with pytest.raises(SchemaError, match="has no class of") as raised:
            generated(request, "cpp", BOTH, "unit", Wishes(holder=manners.name))
        assert f"as own or {'ros2' if encoding == 'cdr' else encoding}" in str(raised.value)


REFUSED = {
    "--language cpp --holder dds": "error[unknown-holder]",
    "--holder protobuf": "`--holder protobuf` says nothing about source in `c`\n  = help: leave it out, or choose --language cpp",
    "--language lisp --holder ros1": "`--holder ros1` says nothing about source in `lisp`",
    "--language python --holder ros1": "`--holder ros1` says nothing about source in `python`",
    "--language cpp --holder yarp --directions decode": "`encode` is not among the directions",
    "--language cpp --holder yarp --directions encode": "`decode` is not among the directions",
    "--emit object --holder own": "`--holder` says nothing about `--emit object`",
    "--target armv7-linux-gnueabihf": "`--target` says nothing about `--emit source`",
}


@pytest.mark.parametrize("options", REFUSED)
def test_options_that_cannot_be_met_are_refused(options, capsys, tmp_path):
    asked = ["generate", "sensor_msgs/JointState", "--encoding", "ros1", *options.split(), "-o", str(tmp_path)]
    assert main(asked) == 1
    assert REFUSED[options] in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_mapping_that_decodes_alone_has_no_encoder():
    request = request_of("decode", {"encoding": "yarp3"}, mapping="yarp/icub/torso_state.mapping")
    text = generated(request, "cpp", ("decode",), "torso")["torso.hpp"]
    assert "try_decode(" in text
    assert "encode(" not in text.replace("decode(", "")


ONE_OF = """syntax = "proto3"; package h; message last_is_warning { int32 x = 1; }
message Hand { oneof last { string warning = 1; last_is_warning touched = 2; int32 class = 3; } int32 last_is_class = 4; }"""
CASES = """#include "unit.hpp"
int main()
{
    unit::Hand hand;
    hand.last = std::string("hot");
    static_assert(unit::Hand::last_is_touched == 2 && unit::Hand::last_is_class_ == 3, "a field has the other name");
    return hand.last.index() == unit::Hand::last_is_warning && std::get<unit::Hand::last_is_warning>(hand.last) == "hot" ? 0 : 1;
}
"""


@cpp.needs_cpp
def test_cases_of_a_union_have_constants(tmp_path):
    """A variant has no names of its own."""
    request = type_request("decode", "h.Hand", {"encoding": "protobuf", "schema": {"h.proto": ONE_OF}})
    cpp.write(tmp_path, generated(request, "cpp", BOTH, "unit"))
    (tmp_path / "main.cpp").write_text(CASES)
    command = ["g++", "-std=c++17", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror", "main.cpp", "unit.cpp", "-o", "main"]
    subprocess.run([*command, f"-I{tmp_path}"], cwd=tmp_path, check=True)
    subprocess.run([tmp_path / "main"], check=True)


@cpp.needs_cpp
def test_a_constant_may_be_called_as_a_type(tmp_path):
    schema = "uint8 Wheel=3\nWheel w\nWheel[] ws\n===\nMSG: a/Wheel\nuint8 x\n"
    cpp.write(tmp_path, generated(type_request("decode", "a/Car", {"encoding": "ros1", "schema": schema}), "cpp", BOTH, "unit"))
    subprocess.run(["g++", "-std=c++17", "-fsyntax-only", f"-I{tmp_path}", tmp_path / "unit.cpp"], check=True)
