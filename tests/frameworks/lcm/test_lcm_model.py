"""What a `.lcm` file becomes: one feature of the language a test."""

from __future__ import annotations

import math

import pytest

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.lcm.fingerprint import enum_hash
from rosetta_jit.frameworks.lcm.idl import parse
from rosetta_jit.frameworks.lcm.schema import floating, integer
from rosetta_jit.frameworks.lcm.shape import written_sizes
from rosetta_jit.model import expr
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Ref, String
from rosetta_jit.source import Source
from tests.frameworks.lcm.lcm_files import Generated, nothing


def told(name):
    return expr.Path("wire", (expr.Member(name),))


def struct(text, name="t", load=nothing):
    return parse(Source("a.lcm", text), load).types[name]


def types(text):
    return {each.name: each.type for each in struct(f"struct t {{ {text} }}").fields}


def test_primitives():
    found = types("int8_t a; int16_t b; int32_t c; int64_t d; float e; double f; string g; boolean h; byte i;")
    assert list(found.values()) == [
        *(Int(bits, spelling=f"int{bits}_t") for bits in (8, 16, 32, 64)),
        *(Float(32, "float"), Float(64, "double"), String("utf-8", "string"), Bool("boolean"), Int(8, signed=False, spelling="byte")),
    ]


def test_arrays():
    found = types("const int32_t K = 4; int32_t n; float a[3][n][K];")
    assert found["a"] == Array(Array(Array(Float(32, "float"), 4), told("n")), 3)


def test_arrays_of_bytes_are_bytes():
    found = types("int32_t n; byte a[n]; byte b[3]; byte c[2][n];")
    assert [found["a"], found["b"]] == [Bytes("byte", told("n")), Bytes("byte", 3)]
    assert found["c"] == Array(Bytes("byte", told("n")), 2)


def test_several_fields_a_declaration():
    assert types("int8_t a, b[2], c;") == {
        "a": Int(8, spelling="int8_t"),
        "b": Array(Int(8, spelling="int8_t"), 2),
        "c": Int(8, spelling="int8_t"),
    }


def test_constants():
    found = struct("struct t { const int32_t A = 1, B = -0x10; const double PI = 3.5; const int8_t O = 010; }").constants
    assert [(each.name, each.type.spelling, each.value) for each in found] == [
        *(("A", "int32_t", 1), ("B", "int32_t", -16)),
        *(("PI", "double", 3.5), ("O", "int8_t", 8)),
    ]


def test_sizes_are_kept_as_they_were_written():
    fields = struct("struct t { const int8_t K = 0x2; int8_t n; int8_t a[K][n][03]; int8_t b[2][n]; }").fields
    assert [written_sizes(each) for each in fields] == [(), ("0x2", "n", "03"), ("2", "n")]
    assert not fields[2].options


def test_packages():
    schema = parse(
        Source("a.lcm", "struct a { } package p.q; struct b { a x; } struct r.c { p.q.b y; b z; } package s; enum e { A }"), nothing_but_a
    )
    assert list(schema.types) == ["a", "p.q.b", "r.c", "s.e", "p.q.a"]
    assert [each.type for each in schema.types["r.c"].fields] == [Ref("p.q.b"), Ref("p.q.b")]


def nothing_but_a(path):
    return Source(path, "package p.q; struct a { }") if path == "p/q/a.lcm" else None


def test_enums_are_open_and_count_on_from_the_largest():
    assert struct("enum t { A, B = 7; C = -2 D }") == Enum("t", (("A", 1), ("B", 7), ("C", -2), ("D", 8)), closed=False)


def test_the_fingerprint_of_an_enum_is_that_of_its_name(tmp_path):
    path = tmp_path / "a.lcm"
    path.write_text("package enums_p;\nenum color_t { RED, GREEN }\n")
    with Generated(tmp_path, path) as classes:
        assert enum_hash("enums_p.color_t").to_bytes(8, "big") == classes["enums_p.color_t"]._get_packed_fingerprint()


def test_recursion():
    found = struct("package p; struct node_t { int8_t n; node_t a[n]; p.node_t b[n]; }", "p.node_t")
    assert [each.type for each in found.fields[1:]] == [Array(Ref("p.node_t"), told("n"))] * 2


def test_comments_document_what_follows():
    text = """// of the file
        package p; // of the package
        /* of the
         * struct */
        struct t // not this
        {
            // of the field
            int8_t a; // behind it
            int8_t b;
            /** of the constant */
            const int8_t C = 1;
        }"""
    found = struct(text, "p.t")
    assert (found.doc, [each.doc for each in found.fields]) == ("of the\nstruct", ["of the field", ""])
    assert found.constants[0].doc == "of the constant"


@pytest.mark.parametrize("place", ["p/u.lcm", "lcm/p/u.lcm", "u.lcm"])
def test_types_are_found_in_the_file_of_their_name(place):
    def load(path):
        return Source(path, "package p; struct u { int8_t a; }") if path == place else None

    schema = parse(Source("a.lcm", "struct t { p.u x; }"), load)
    assert list(schema.types) == ["t", "p.u"]
    assert schema.sources == ("a.lcm", place)


def test_types_are_found_beside_the_file_that_uses_them():
    texts = {"x/p/u.lcm": "package p; struct u { v a; }", "p/u.lcm": "package p; struct u { v a; }", "p/v.lcm": "package p; struct v { }"}

    def load(path):
        return Source(path, texts[path]) if path in texts else None

    assert list(parse(Source("a.lcm", "struct t { p.u x; }"), load).types) == ["t", "p.u", "p.v"]


def test_a_file_that_declares_something_else_is_passed_over():
    def load(path):
        return Source(path, "package q; struct u { }" if path == "p/u.lcm" else "package p; struct u { int8_t a; }")

    assert list(parse(Source("a.lcm", "struct t { p.u x; }"), load).types) == ["t", "p.u"]


def test_mistakes_in_other_files_are_reported_there():
    with pytest.raises(SchemaError, match=r"--> p/u.lcm:1:29"):
        parse(Source("a.lcm", "struct t { p.u x; }"), lambda path: Source(path, "package p; struct u { int8_t; }"))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0", 0),
        ("10", 10),
        ("-7", -7),
        ("0x1F", 31),
        ("0Xf", 15),
        ("017", 15),
        ("08", None),
        ("1_0", None),
        ("0b1", None),
        ("", None),
        ("٣", None),
    ],
)
def test_integers(text, value):
    assert integer(text) == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1.0),
        ("-.5", -0.5),
        ("5.", 5.0),
        ("1e-3", 0.001),
        ("0x10", 16.0),
        ("0x1p-1", 0.5),
        ("1e400", None),
        ("inf", None),
        ("1_0", None),
    ],
)
def test_reals(text, value):
    assert floating(text) == value


def test_minus_zero_keeps_its_sign():
    assert math.copysign(1, floating("-0.0")) == -1
