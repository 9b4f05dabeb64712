"""Fields, types, constants and cases may be called as words of the target language are, its macros and built-ins among them."""

from __future__ import annotations

import builtins
import keyword
import random
import re
import shutil
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api import programs
from rosetta_jit.api.options import type_request
from rosetta_jit.cli import main
from rosetta_jit.generate.build import NO_WISHES, Wishes, generated
from rosetta_jit.generate.c.words import RESERVED
from rosetta_jit.generate.cpp.objects.manners import PROTOC
from rosetta_jit.generate.lisp.words import runtime_names, symbols
from rosetta_jit.model.types import Ref
from tests.generate import cpp, driver, lisp, native, python
from tests.generate.python import module
from tests.generate.test_cpp import same
from tests.runtime.test_shipped_growth import likely

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    Through = Callable[[list["Case"], Path], Iterator[list[str]]]

BOTH = ("decode", "encode")
AT_ONCE: dict[str | tuple[str, str], int] = {
    "others": 60,
    "types that contain themselves": 20,
    "lisp": 12,
    ("lisp", "types"): 4,
    ("lisp", "nested types"): 4,
    ("lisp", "types that contain themselves"): 2,
}
"""How many names become one unit: fewer of what compilers take longer for than there is more of it."""
UNITS_AT_ONCE = 25
"""So many units are given to one process of SBCL, which compiles its runtime once."""
ROOM = 1 << 14
"""Elements, and bytes, for which generated C has room where nothing bounds them: types that contain themselves have many here."""
OURS = """
unit holder codec decode encode size borrow error result status failure message memory rows used capacity count start which state kept now
number line path kind detail offset value target element inner row index data end begin bytes lane lanes scratch sites site unknown_fields
string vector optional variant map array span std rosetta_jit type name position function list self field
"""
"""Words of generated source itself."""
HEADERS = (
    "assert complex ctype errno fenv float inttypes limits locale math setjmp signal stdbool stddef stdint stdio stdlib string time wchar"
)


def in_c() -> set[str]:
    """Words of C and C++, some of each family of macros."""
    families = re.compile(r"(SYS|CLONE|STA|ADJ|MOD|M|LC|PTHREAD|CLOCK|SCHED|SIG|NL|BC|XATTR|HUGE_VAL|PRI|SCN|U?INT)_?\w+|E[A-Z]+")
    return {each for each in RESERVED if not families.fullmatch(each)} | {
        "M_PI",
        "EAGAIN",
        "SIGINT",
        "INT_MAX",
        "EOF",
        "INT8_MAX",
        "PRId64",
    }


def in_python() -> set[str]:
    return {*keyword.kwlist, *keyword.softkwlist, *dir(builtins), "dataclass", "Struct", "Any", "math", "np", "annotations"}


def in_lisp() -> set[str]:
    return {each.replace("-", "_") for each in symbols() | runtime_names()}


def of_protoc() -> set[str]:
    """What it renames, but for what its own classes cannot have; and what it leaves alone, though it is reserved in our own classes."""
    return PROTOC - {"NULL", "case"} | {"min", "max", "near", "far", "small", "interface", "sin", "size", "data", "string", "map", "unit"}


WORDS = {"c": in_c, "cpp": in_c, "python": in_python, "lisp": in_lisp, "protoc": of_protoc}


def words(language: str) -> list[str]:
    """Those that a schema may have, each of another name in JSON."""
    ours = set() if language == "protoc" else set(OURS.split())
    found: dict[str, str] = {}
    for each in sorted(WORDS[language]() | ours):
        if re.fullmatch(r"[A-Za-z_]\w*", each) and each.strip("_"):
            found.setdefault(each.replace("_", "").lower(), each)
    return sorted(found.values())


def fields(kind: str) -> Callable[[list[str]], tuple[str, str]]:
    return lambda some: ("", " ".join(f"{kind} {each} = {number};" for number, each in enumerate(some, 1)))


def types(form: str, use: str) -> Callable[[list[str]], tuple[str, str]]:
    def made(some: list[str]) -> tuple[str, str]:
        of = list(enumerate(some, 1))
        return " ".join(form.format(each, n=n) for n, each in of), " ".join(f"{use.format(each, n=n)} = {n};" for n, each in of)

    return made


def constants(some: list[str]) -> tuple[str, str]:
    values = " ".join(f"{each} = {number};" for number, each in enumerate(some))
    return f"enum E {{ {values} }}", "E one = 1; repeated E many = 2;"


def cases(some: list[str]) -> tuple[str, str]:
    kinds = ("int32", "string", "bytes", "Sub")
    inner = " ".join(f"{kinds[number % 4]} {each} = {number};" for number, each in enumerate(some, 1))
    return "", f"oneof choice {{ {inner} }}"


def oneofs(some: list[str]) -> tuple[str, str]:
    return "", " ".join(f"oneof {each} {{ int32 a{n} = {2 * n}; string b{n} = {2 * n + 1}; }}" for n, each in enumerate(some, 1))


def nested(some: list[str]) -> tuple[str, str]:
    inner = "message {0}_ {{ int32 {0} = 1; }} .h.Outer.{0}.{0}_ in_ = 1; repeated .h.Outer.{0}.{0}_ {0} = 2;"
    form = f"message {{0}} {{{{ {inner} }}}} .h.Outer.{{0}} f{{1}} = {{1}};"
    return "", " ".join(form.format(each, number) for number, each in enumerate(some, 1))


ROLES: dict[str, Callable[[list[str]], tuple[str, str]]] = {
    "numbers": fields("int32"),
    "bools": fields("optional bool"),
    "arrays": fields("repeated double"),
    "bytes": fields("bytes"),
    "texts": fields("string"),
    "lists of texts": fields("repeated string"),
    "maps": fields("map<string, int32>"),
    "types": types("message {0} {{ int32 {0} = 1; repeated int32 n = 2; }}", ".h.{0} f{n}"),
    "types and fields": types("message {0} {{ int32 x = 1; }}", ".h.{0} {0}"),
    "types that contain themselves": types("message {0} {{ int32 {0} = 1; repeated .h.{0} n = 2; }}", "repeated .h.{0} f{n}"),
    "enums": types("enum {0} {{ a{n} = 0; b{n} = 1; }}", ".h.{0} f{n}"),
    "constants": constants,
    "cases": cases,
    "oneofs": oneofs,
    "nested types": nested,
}
"""What a name may be the name of: types, and fields of the message."""


@dataclass(frozen=True)
class Case:
    """A type with such names, and messages."""

    text: str
    request: Any
    pair: tuple[rj.Decoder, rj.Encoder]
    messages: list[bytes]

    def wanted(self) -> list[str]:
        return [driver.expected(*self.pair, each) for each in self.messages]


def case(role: str, some: list[str]) -> Case:
    others, body = ROLES[role](some)
    text = f'syntax = "proto3"; package h;\nmessage Sub {{ int32 x = 1; }}\n{others}\nmessage Outer {{ {body} }}\n'
    options: Any = {"encoding": "protobuf", "schema": {"h.proto": text}}
    request = type_request("decode", "h.Outer", options)
    decode, encode = rj.Decoder.of("h.Outer", **options), rj.Encoder.of("h.Outer", **options)
    rng, model = random.Random(role), programs.build_of(request).types
    if role == "maps":
        values: list[Any] = [{each: {"k": 1, "": 2} for each in some}, {some[0]: {}}]
    else:
        values = [likely(Ref(model.holder.name), model.schema, ["x", "yz", ""], rng) for _ in range(4)]
    good = [bytes(encode(encode.holder_type.from_dict(each))) for each in values]
    return Case(text, request, (decode, encode), [*good, *driver.harmed(good[:2], 2, role)])


def through_c(made: Case, folder: Path) -> list[str]:
    name = driver.write(folder, texts := generated(made.request, "c", BOTH, "unit"))
    (folder / "standard.h").write_text("".join(f"#include <{each}.h>\n" for each in HEADERS.split()))
    unbounded = re.findall(r"#ifndef (UNIT_\w+)\n#define \1 \d", "".join(texts.values()))
    options = ("-O0", "-std=gnu11", "-include", "standard.h", *(f"-D{each}={ROOM}" for each in unbounded))
    if shutil.which("clang") is not None:
        driver.compiled("clang", folder, name, *options, "-fsyntax-only")
    return driver.answers(driver.driver(folder, name, options=options), made.messages)


def through_cpp(made: Case, folder: Path) -> list[str]:
    name = cpp.write(folder, generated(made.request, "cpp", BOTH, "unit"))
    (folder / "standard.h").write_text("".join(f"#include <c{each}>\n" for each in HEADERS.split() if each != "complex"))
    options = ("-O0", "-std=gnu++20", "-include", "standard.h")
    if shutil.which("clang++") is not None:
        cpp.compiled("clang++", folder, name, *options)
    return driver.answers(cpp.program(folder, name, options=options), made.messages)


def through_python(made: Case, folder: Path) -> list[str]:
    unit = module(made.request, BOTH, NO_WISHES)
    return [python.answer(unit, each) for each in made.messages]


def through_lisp(cases: list[Case], folder: Path) -> Iterator[list[str]]:
    """What Lisp says of values, too, is compared here."""
    answers = lisp.answers(folder, [(made.request, made.messages) for made in cases], lisp.QUICKLY)
    for made, found in zip(cases, answers, strict=True):
        for line, wanted in zip(found, lisp.expected(made.request, *made.pair, made.messages), strict=True):
            assert line == wanted
        yield made.wanted()


def one_by_one(through: Callable[[Case, Path], list[str]]) -> Through:
    def answers(cases: list[Case], folder: Path) -> Iterator[list[str]]:
        for number, made in enumerate(cases):
            (inner := folder / str(number)).mkdir()
            yield through(made, inner)

    return answers


def through_protoc(made: Case, folder: Path) -> list[str]:
    """Classes that the real protoc makes."""
    native.protoc(folder, "h", made.text)
    name = cpp.write(folder, generated(made.request, "cpp", BOTH, "unit", Wishes(holder="protobuf", include="h.pb.h")))
    return driver.answers(native.program_of_protoc(folder, name, "h", cpp.PLAIN), made.messages)


LANGUAGES = {
    "c": pytest.param("c", one_by_one(through_c), marks=driver.needs_gcc, id="c"),
    "cpp": pytest.param("cpp", one_by_one(through_cpp), marks=cpp.needs_cpp, id="cpp"),
    "python": pytest.param("python", one_by_one(through_python), id="python"),
    "lisp": pytest.param("lisp", through_lisp, marks=lisp.needs_sbcl, id="lisp"),
    "protoc": pytest.param("protoc", one_by_one(through_protoc), marks=cpp.needs_cpp, id="protoc"),
}
NOT_OF_PROTOC = {"types", "types and fields", "types that contain themselves", "nested types", "constants"}
"""What its own classes cannot have: a member that is called as its class, say."""


def compare(language: str, through: Through, role: str, groups: list[list[str]], folder: Path) -> None:
    cases = [case(role, some) for some in groups]
    for made, lines in zip(cases, through(cases, folder), strict=True):
        assert any(each.startswith("ok ") for each in made.wanted())
        for line, wanted, message in zip(lines, made.wanted(), made.messages, strict=True):
            is_map = role == "maps" and line.startswith("ok ") and wanted.startswith("ok ")  # whose entries come in any order
            assert line == wanted or (is_map and sorted(line) == sorted(wanted)), (language, message.hex())


FEW = {
    "c": ["numbers"],
    "cpp": ["numbers", "types"],
    "python": ["numbers", "types that contain themselves", "cases"],
    "lisp": ["arrays"],
    "protoc": ["numbers", "oneofs"],
}
CHOSEN = {
    "c": "errno EOF NULL unix SIG_ATOMIC_MAX WCHAR_MIN LDBL_MAX DBL_TRUE_MIN I complex EAGAIN INT_MAX",
    "cpp": "errno EOF NULL unix SIG_ATOMIC_MAX WCHAR_MIN LDBL_MAX DBL_TRUE_MIN class final EAGAIN INT_MAX unknown_fields",
    "python": "class match int index None len __debug__ type",
    "lisp": "array list t nil pi string type vector function class unknown_fields unit",
    "protoc": "class min max near int sin default",
}


@pytest.mark.parametrize(("language", "through", "role"), [(*LANGUAGES[each].values, role) for each, some in FEW.items() for role in some])
def test_some(language, through, role, tmp_path):
    if language == "protoc":
        native.needs_protoc()
    if language in ("c", "cpp", "lisp") and shutil.which({"c": "gcc", "cpp": "g++", "lisp": "sbcl"}[language]) is None:
        pytest.skip("the compiler is not installed")
    compare(language, through, role, [CHOSEN[language].split()], tmp_path)


UNITS = [
    ("std_msgs/Bool", "c", "bool.c"),
    ("std_msgs/Bool", "cpp", "std_msgs_bool.cpp"),
    ("std_msgs/Char", "cpp", "std_msgs_char.cpp"),
    ("std_msgs/Bool", "python", "bool.py"),
    ("std_msgs/String", "python", "std_msgs_string.py"),
]


@pytest.mark.campaign
@pytest.mark.parametrize("role", ROLES)
@pytest.mark.parametrize(("language", "through"), LANGUAGES.values())
def test_all(language, through, role, tmp_path):
    if language == "protoc" and role in NOT_OF_PROTOC:
        pytest.skip("protoc's own classes do not compile")
    some = [each for each in words(language) if each != "in"]
    at_once = next(AT_ONCE[each] for each in ((language, role), language, role, "others") if each in AT_ONCE)
    groups = [some[begin : begin + at_once] for begin in range(0, len(some), at_once)]
    for begin in range(0, len(groups), UNITS_AT_ONCE):
        folder = tmp_path / str(begin)
        folder.mkdir()
        compare(language, through, role, groups[begin : begin + UNITS_AT_ONCE], folder)


@pytest.mark.parametrize(("type_", "language", "file"), UNITS)
def test_units_are_not_called_as_words_of_their_language(type_, language, file, tmp_path, capsys):
    """By default the package's name stands before such a word; who asks for the word is refused."""
    arguments = ["generate", type_, "--encoding", "ros1", "--language", language, "-o", str(tmp_path)]
    assert main(arguments) == 0
    assert (tmp_path / file).exists()
    word = type_.rsplit("/", maxsplit=1)[1].lower()
    assert (main([*arguments, "--name", word]) == 0) == (file.split(".")[0] == word)
    assert (file.split(".")[0] == word) == ("unusable-name" not in capsys.readouterr().err)
    if language == "cpp" and shutil.which("g++") is not None:
        cpp.compiled("g++", tmp_path, file.removesuffix(".cpp"))


CALLED_AS_TYPES = """part part
part[] parts
other[2] other
outer3 outer3
""" + "".join(
    f"{'=' * 80}\nMSG: t/{name}\n{fields}"
    for name, fields in {
        "part": "int16 part\nother other\nint8 unit\n",
        "other": "int8 x\npart3 part3\n",
        "part3": "int8 outer\n",
        "outer3": "int16[] part\n",
    }.items()
)


@cpp.needs_cpp
def test_fields_are_called_as_their_types_in_cpp(tmp_path):
    """As those of bottles within bottles are: the name of a member does not depend on how many stand before it."""
    options = {"encoding": "ros1", "schema": CALLED_AS_TYPES}
    texts = generated(type_request("decode", "t/outer", options), "cpp", BOTH, "unit")
    for member in (
        "::unit::part part{};",
        "std::vector<::unit::part> parts;",
        "std::array<::unit::other, 2> other{};",
        "::unit::other other{};",
    ):
        assert f"    {member}\n" in texts["unit.hpp"]
    made = cpp.program(tmp_path, cpp.write(tmp_path, texts), options=cpp.WATCHED)
    inner = {"part": -2, "other": {"x": 3, "part3": {"outer": 4}}, "unit": 5}
    value = {"part": inner, "parts": [inner] * 2, "other": [inner["other"]] * 2, "outer3": {"part": [1, -1]}}
    decode, encode = (of("t/outer", **options) for of in (rj.Decoder.of, rj.Encoder.of))
    messages = driver.harmed([bytes(encode(value))], 20, "called as types")
    same(driver.answers(made, messages), decode, encode, messages)


LEG = """package leg;
struct leg { const int8_t OK = 1, EOF = 2; double q[3]; int8_t leg; int32_t n; codec parts[n]; span s; holder h; }
struct codec { int8_t leg; int8_t codec; }
struct span { int8_t leg; int32_t n; span s[n]; }
struct holder { int8_t x; string class; }
"""
"""A type is called as its unit, others as types of the header, a constant and a field as words."""
A_LEG = {
    "q": [1, 2, 3],
    "leg": 4,
    "n": 1,
    "parts": [{"leg": 5, "codec": 6}],
    "s": {"leg": 7, "n": 1, "s": [{"leg": 8, "n": 0, "s": []}]},
    "h": {"x": 9, "class": "y"},
}
READABLE = {
    "c": ["} leg_leg;", "} leg_holder_;", "} leg_span_;", "    int8_t leg;", "#define leg_leg_EOF 2\n", "leg_span class_;"],
    "cpp": ["struct leg {", "struct codec_ {", "struct holder_ {", "int8_t leg_{};", "int8_t EOF_ = 2;", "std::string class_;"],
    "python": ["class leg:", "class codec:", "    leg: int", "    EOF = 2\n", "    class_: str"],
    "lisp": ["(defclass leg ", "(defclass codec-message ", "(defclass holder ", "(defconstant +leg.eof+ 2)", "   (class :initarg"],
}


@pytest.mark.parametrize(("language", "program"), [("c", driver.driver), ("cpp", cpp.program), ("python", None), ("lisp", None)])
def test_what_is_called_as_a_word_ends_with_an_underscore_and_not_in_a_number(language, program, tmp_path):
    """A package, its file and its type are often called the same in LCM: for that, none of them is called otherwise."""
    options: Any = {"encoding": "lcm", "schema": {"leg.lcm": LEG}}
    texts = generated(type_request("decode", "leg.leg", options), language, BOTH, "leg")
    for each in READABLE[language]:
        assert each in "".join(texts.values())
    if program is None or shutil.which("g++") is None:
        return
    made = program(tmp_path, (driver.write if language == "c" else cpp.write)(tmp_path, texts))
    decode, encode = (of("leg.leg", **options) for of in (rj.Decoder.of, rj.Encoder.of))
    messages = driver.harmed([bytes(encode(A_LEG))], 5, "leg")
    same(driver.answers(made, messages), decode, encode, messages)
