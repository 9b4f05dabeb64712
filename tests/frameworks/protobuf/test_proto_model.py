"""What becomes of each construct of the language."""

from __future__ import annotations

import pytest

from rosetta_jit.frameworks.protobuf.idl import parse
from rosetta_jit.model.types import Array, Enum, Field, Float, Int, Map, Optional, Ref, String, Union
from rosetta_jit.source import Source
from tests.frameworks.protobuf.proto_files import IDL, VECTORS, load_from, source

INT32 = Int(32, True, "int32")


def types(text: str, syntax: str = "proto2"):
    return parse(Source("a.proto", f'syntax = "{syntax}";\n{text}'), lambda _: None).types


def field(declaration: str, syntax: str = "proto2") -> Field:
    return types(f"message M {{ {declaration} }} enum E {{ ZERO = 0; ONE = 1; }}", syntax)["M"].fields[0]


@pytest.mark.parametrize(
    ("syntax", "declaration", "type_"),
    [
        ("proto2", "optional int32 a = 1;", Optional(INT32)),
        ("proto2", "required int32 a = 1;", Optional(INT32)),
        ("proto2", "repeated int32 a = 1;", Array(INT32)),
        ("proto2", "optional M a = 1;", Optional(Ref("M"))),
        ("proto2", "map<string, M> a = 1;", Map(String("utf-8", "string"), Ref("M"))),
        ("proto2", "repeated group A = 1 {}", Array(Ref("M.A"))),
        ("proto3", "int32 a = 1;", INT32),
        ("proto3", "optional int32 a = 1;", Optional(INT32)),
        ("proto3", "repeated E a = 1;", Array(Ref("E"))),
        ("proto3", "E a = 1;", Ref("E")),
        ("proto3", "M a = 1;", Optional(Ref("M"))),
    ],
)
def test_type_of_a_field(syntax, declaration, type_):
    assert field(declaration, syntax).type == type_


@pytest.mark.parametrize(
    ("syntax", "declaration", "options"),
    [
        ("proto2", "repeated int32 a = 1;", (("packed", False),)),
        ("proto3", "repeated int32 a = 1;", (("packed", True),)),
        ("proto3", "repeated E a = 1 [packed = false];", (("packed", False),)),
        ("proto3", "repeated string a = 1;", ()),
        ("proto2", "optional group A = 1 {}", (("group", True),)),
        (
            "proto2",
            "optional int64 a = 1 [deprecated = true, jstype = JS_STRING];",
            (("option.deprecated", True), ("option.jstype", "JS_STRING")),
        ),
    ],
)
def test_options_of_a_field(syntax, declaration, options):
    assert field(declaration, syntax).options == options


def test_required_is_tracked_and_demanded():
    assert field("required int32 a = 1;").required
    assert not field("optional int32 a = 1;").required


def test_group_field_has_a_lower_case_name():
    assert field("optional group FooBar = 1 {}").name == "foobar"


@pytest.mark.parametrize(
    ("declaration", "default"),
    [
        ("optional E a = 1 [default = ONE];", 1),
        ("optional bytes a = 1 [default = 'a\\000\\xff'];", b"a\x00\xff"),
        ("optional string a = 1 [default = 'a' \"b\"];", "ab"),
        ("optional float a = 1 [default = 0.1];", 0.10000000149011612),
        ("optional bool a = 1 [default = true];", True),
        ("optional int32 a = 1;", None),
    ],
)
def test_default(declaration, default):
    assert field(declaration).default == default


def test_oneof_is_one_field_where_its_first_member_stands():
    text = "message M { optional int32 a = 1; oneof pick { int32 b = 2; string c = 3; } optional int32 d = 4; }"
    cases = (Field("b", INT32, 2), Field("c", String("utf-8", "string"), 3))
    fields = types(text)["M"].fields
    assert [one.name for one in fields] == ["a", "pick", "d"]
    assert fields[1] == Field("pick", Union("M.pick", cases))


def test_extension_is_a_field_of_the_extended_message():
    text = "package p; message M { extensions 5 to 9; } message N { extend M { optional float x = 6; } }"
    added = types(text)["p.M"].fields[0]
    assert added == Field("[p.N.x]", Optional(Float(32, "float")), 6, options=(("extension", True),))


def test_enums_are_closed_in_proto2_and_open_in_proto3():
    assert types("enum E { A = 0; }")["E"] == Enum("E", (("A", 0),), closed=True)
    assert types("enum E { A = 0; }", "proto3")["E"] == Enum("E", (("A", 0),), closed=False)


@pytest.mark.parametrize(
    ("before", "doc"),
    [
        ("// One.\n  // Two.\n  ", "One.\nTwo."),
        ("/* One.\n   * Two. */\n  ", "One.\nTwo."),
        ("// Detached.\n\n  ", ""),
        ("optional int32 z = 9; // Of z.\n  ", ""),
        ("optional int32 z = 9; /* Of z. */\n  ", ""),
        ("", ""),
    ],
)
def test_leading_comment_is_the_doc(before, doc):
    found = types(f"// The message.\nmessage M {{\n  {before}optional int32 a = 1;\n}}")["M"]
    assert found.doc == "The message."
    assert found.fields[-1].doc == doc


@pytest.mark.parametrize(
    ("behind", "doc"),
    [
        ("; // Of a.", "Of a."),
        (" [deprecated = true];  /* Of a. */", "Of a."),
        ("; /// Of a.", "Of a."),
        (";\n// Of b.", ""),
        ("; optional int32 c = 3; // Of c.", ""),
        ("; /* Of\n all. */", ""),
        (";", ""),
    ],
)
def test_a_comment_behind_a_field_is_its_doc(behind, doc):
    found = types(f"message M {{ optional int32 a = 1{behind}\n}}")
    assert found["M"].fields[0].doc == doc


def test_a_comment_before_a_field_goes_before_one_behind_it():
    found = types("message M {\n  // Before.\n  optional int32 a = 1; // Behind.\n  optional int32 b = 2;\n}")["M"]
    assert [each.doc for each in found.fields] == ["Before.", ""]


def test_spans_point_at_names():
    text = 'syntax = "proto2"; message Mess { optional int32 apple = 1; }'
    struct = parse(Source("a.proto", text), lambda _: None).types["Mess"]
    assert text[struct.span.start : struct.span.end] == "Mess"
    assert text[struct.fields[0].span.start : struct.fields[0].span.end] == "apple"


def test_a_byte_order_mark_and_windows_lines_are_blanks():
    assert set(parse(Source("a.proto", '\ufeffsyntax = "proto3";\r\nmessage M {}\r\n'), lambda _: None).types) == {"M"}


def test_sources_are_in_the_order_of_dependence():
    schema = parse(source(VECTORS, "imports.proto"), load_from(VECTORS))
    assert schema.sources[:3] == ("sub/base.proto", "sub/empty.proto", "sub/public.proto")
    assert schema.sources[-1] == "imports.proto"


def test_units_of_joint_angles_are_told():
    schema = parse(source(IDL, "rst/kinematics/JointAngles.proto"), load_from(IDL))
    assert schema.types["rst.kinematics.JointAngles"].fields[0].doc == "Joint angles, in rad."
