"""The front end of bottle schemas: what a schema means, and what it is told when it means nothing."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp.bottle_schema.front_end import parse
from rosetta_jit.frameworks.yarp.tags import vocab
from rosetta_jit.model.expr import Binary, Call, Literal, Member
from rosetta_jit.model.expr import Path as Place
from rosetta_jit.model.types import Array, Bool, Bytes, Field, Float, Int, Map, Ref, String, Struct
from rosetta_jit.source import Source
from tests.golden import check_golden

ROOT = Path(__file__).parents[3]
GOLDEN = ROOT / "tests" / "golden" / "bottle_schema"

PAPER = """
"yarp.icub.torso.command"
( ("action" (:vocab :|set|) :|set|)
  ("mode" (:vocab :|poss|) :|poss|)
  ("angles" (:bottle ("a0" :double (:unit :degree)) ("a1" :double (:unit :degree)) ("a2" :double (:unit :degree)))) )
"""


def nothing(path):
    return None


def declared(text, load=nothing):
    return parse(Source("test", text), load).types


def field(text):
    return declared(f'"t" (("n" :int) ("g" (:bottle ("w" :int))) {text})')["t"].fields[-1]


def test_reads_the_example_of_the_paper():
    double = Float(64, "float64")
    word = Int(32, True, "vocab32")
    angles = Struct("yarp.icub.torso.command.angles", tuple(Field(f"a{i}", double, unit="degree") for i in range(3)))
    assert declared(PAPER) == {
        "yarp.icub.torso.command": Struct(
            "yarp.icub.torso.command",
            (
                Field("action", word, constant=Literal(0x746573)),
                Field("mode", word, constant=Literal(vocab(b"poss"))),
                Field("angles", angles),
            ),
        )
    }


@pytest.mark.parametrize(
    ("text", "type_"),
    [
        (":int8", Int(8, True, "int8")),
        (":uint8", Int(8, False, "int8")),
        (":int16", Int(16, True, "int16")),
        (":int", Int(32, True, "int32")),
        (":int32", Int(32, True, "int32")),
        (":int64", Int(64, True, "int64")),
        (":float32", Float(32, "float32")),
        (":double", Float(64, "float64")),
        (":float64", Float(64, "float64")),
        (":vocab", Int(32, True, "vocab32")),
        (":vocab64", Int(64, True, "vocab64")),
        (":string", String("octets", "string")),
        (":blob", Bytes("blob")),
        (":bool", Bool("bool")),
        (":quantum", Int(32, True, "quantum")),
        ("(:list :int8)", Array(Int(8, True, "int8"))),
        ("(:list :int8 (:length 16))", Array(Int(8, True, "int8"), 16)),
        ("(:list (:list :blob) (:length 2))", Array(Array(Bytes("blob")), 2)),
        ("(:bottle)", Struct("t.x", ())),
        ('(:list (:bottle ("y" :blob)))', Array(Struct("t.x", (Field("y", Bytes("blob")),)))),
        ("(:dict :blob)", Map(String("octets", "string"), Bytes("blob"))),
        ("(:dict (:list :blob))", Map(String("octets", "string"), Array(Bytes("blob")))),
        ('(:dict ("y" :blob))', Struct("t.x", (Field("y", Bytes("blob"), options=(("key", "y"),)),))),
        ('(:dict ("y" :blob (:key "y z")))', Struct("t.x", (Field("y", Bytes("blob"), options=(("key", "y z"),)),))),
        ('"t2"', Ref("t2")),
    ],
)
def test_reads_types(text, type_):
    assert declared(f'"t2" () "t" (("x" {text}))')["t"].fields[0].type == type_


@pytest.mark.parametrize(
    ("text", "constant"),
    [
        (":int8 -128", Literal(-128)),
        (":double 1", Literal(1.0)),
        (":float32 -2.5e3", Literal(-2500.0)),
        (':string "a \\"b\\""', Literal('a "b"')),
        (":bool true", Literal(True)),
        (":vocab :|ok|", Literal(0x6B6F)),
        ("(:vocab :|ok|)", Literal(0x6B6F)),
        (":vocab64 :|hello|", Literal(478560413032)),
        (":int n", Place("wire", (Member("n"),))),
        (":int (+ n 1)", Binary("+", Place("wire", (Member("n"),)), Literal(1))),
        (
            ":int (align g.w (* n 8))",
            Call("align", (Place("wire", (Member("g"), Member("w"))), Binary("*", Place("wire", (Member("n"),)), Literal(8)))),
        ),
    ],
)
def test_reads_constants(text, constant):
    assert field(f'("x" {text})').constant == constant


def test_reads_options():
    assert field('("x" :double (:unit "m/s") (:documentation "How fast.") (:default 1))') == Field(
        "x", Float(64, "float64"), unit="m/s", default=1.0
    )
    assert field('("x" :double (:documentation "How fast."))').doc == "How fast."
    assert field('("x" (:list :int) :rest)').option("rest") is True
    assert field('("x" :blob (:length (* n 2)))').length == Binary("*", Place("wire", (Member("n"),)), Literal(2))
    assert field('("x" :blob (:length 4))').length == Literal(4)
    assert field('("x" (:list :blob) (:length 4))').type == Array(Bytes("blob"), 4)


def test_imports_each_file_once_and_in_any_circle():
    files = {
        "a": '(:import "b") "a" (("x" "b"))',
        "b": '(:import "a") (:import "c") "b" (("x" "c"))',
        "c": '(:import "b") "c" (("x" :int))',
    }
    schema = parse(Source("a", files["a"]), lambda path: Source(path, files[path]))
    assert set(schema.types) == {"a", "b", "c"}
    assert set(schema.sources) == {"a", "b", "c"}


@pytest.mark.parametrize("path", sorted(GOLDEN.glob("*.bottle-schema")), ids=lambda path: path.stem)
def test_says_what_is_wrong(path):
    with pytest.raises(SchemaError) as caught:
        parse(Source(path.name, path.read_text()), nothing)
    check_golden(path.with_suffix(".err"), f"{caught.value}\n")


def test_every_mistake_has_a_golden_file():
    from rosetta_jit.frameworks.yarp import bottle_diagnostics as bottle

    told = "".join(path.read_text() for path in GOLDEN.glob("*.err"))
    lonely = {"unlike_messages", "undescribable_message", "no_messages", "unknown_dialect", "duplicate"}
    lonely |= {"no_such_tag", "packed_element", "blob_of_any_size", "misplaced_union", "like_cases", "not_spread"}  # what an encoding finds
    words = {name.replace("_", "-") for name, value in vars(bottle).items() if callable(value) and value.__module__ == bottle.__name__}
    words -= {name.replace("_", "-") for name in lonely} | {"unknown-type-word", "-error", "-cut", "-nearest"}
    assert {word for word in words if f"[{word}]" not in told} == set()


def test_collects_the_problems_of_all_files():
    with pytest.raises(SchemaError) as caught:
        parse(Source("a", '(:import "b") "a" (("x" :foo))'), lambda path: Source(path, '"b" (("y" :bar))'))
    assert [problem.span.source.name for problem in caught.value.diagnostics] == ["a", "b"]


@pytest.mark.parametrize("path", sorted((ROOT / "idl" / "yarp").rglob("*.bottle-schema")), ids=lambda path: path.stem)
def test_shipped_schemas_are_sound(path):
    schema = parse(Source(path.name, path.read_text()), lambda name: Source(name, (ROOT / "idl" / name).read_text()))
    assert next(iter(schema.types)).startswith(f"yarp.{path.parent.name}.")


@pytest.mark.parametrize(
    "text",
    [
        "(" * 1_000_000,
        ")" * 1_000_000,
        '"a" (("x" ' + "(:list " * 70_000 + ":int" + ")" * 70_000 + "))",
        '"a" (' + '("x" :int)' * 50_000 + ")",
        '"a" (' + ":x " * 50_000 + ")",
        '"a" (("x" :int ' + "9" * 100_000 + "))",
        '"' + "a" * 1_000_000 + '" ()',
        '"a" (("' + "x" * 1_000_000 + '" :int))',
        '"a" (' + "".join(f'("x{i}" "t{i}")' for i in range(20_000)) + ")",
        "".join(f'"t{i}" (("x" "t{i + 1}"))' for i in range(20_000)) + '"t20000" ()',
        '"' + "\\" * 1_000_001,
        "\0\x1b[2J",
        '"a" (("x" :int (:default ' + "(+ 1 " * 5_000,
    ],
    ids=range(13),
)
def test_hostile_schemas_are_refused_in_little_time(text):
    with pytest.raises(SchemaError) as caught:
        declared(text)
    assert len(str(caught.value)) < 100_000


def test_hostile_names_are_refused():
    for name in ("import os", "a\nb", "a'b", 'a\\"b', "a;b", "\N{CYRILLIC SMALL LETTER A}"):
        with pytest.raises(SchemaError, match="cannot be a name"):
            declared(f'"t" (("{name}" :int))')
    assert declared('"t" (("__import__" :int) ("class" :int))')["t"].fields[0].name == "__import__"


TOKENS = st.sampled_from(
    [
        '"a"',
        '"b.c"',
        '"x"',
        "(",
        ")",
        ":int",
        ":double",
        ":list",
        ":bottle",
        ":dict",
        ":vocab",
        ":|set|",
        "5",
        "1.5",
        "+",
        "x.y",
        ":rest",
        ":packed",
        ":bare",
        ":union",
        ":blob",
        ":spread",
        "(:code :double)",
        "(:padding 4)",
        "(:since :yarp4)",
        ":unit",
        ":length",
        ";",
        "\n",
    ]
)


@given(st.lists(TOKENS, max_size=30).map(" ".join))
def test_any_text_is_a_schema_or_refused(text):
    try:
        declared('"a" (("x" ' + text)
        declared(text)
    except SchemaError as error:
        assert str(error)  # noqa: PT017
