"""What the declarations of IDL become in the model; what omniidl says of them too is compared elsewhere."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.omg.idl import parse
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, NamedConstant, Optional, Ref, String, Union
from rosetta_jit.source import Source
from tests.frameworks.omg.idl_files import load_from


def schema(text, **files):
    return parse(Source("a.idl", text), load_from(**files))


def fields(text, name="S"):
    return {field.name: field for field in schema(text).types[name].fields}


def one(text):
    """The type of the only member of the struct `S`."""
    (field,) = schema(f"struct S {{ {text} }};").types["S"].fields
    return field.type


@pytest.mark.parametrize(
    ("text", "type_"),
    [
        ("boolean x;", Bool("boolean")),
        ("char x;", Int(8, signed=False, spelling="char")),
        ("wchar x;", Int(16, signed=False, spelling="wchar")),
        ("octet x;", Int(8, signed=False, spelling="octet")),
        ("int8 x;", Int(8, spelling="int8")),
        ("uint64 x;", Int(64, signed=False, spelling="uint64")),
        ("unsigned long long x;", Int(64, signed=False, spelling="unsigned long long")),
        ("float x;", Float(32, "float")),
        ("string<7> x;", String("utf-8", "string", 7)),
        ("wstring x;", String("utf-16", "wstring")),
        ("sequence<octet> x;", Bytes("octet")),
        ("sequence<uint8, 3> x;", Bytes("uint8", maximum=3)),
        ("octet x[2][3];", Array(Bytes("octet", length=3), 2)),
        ("sequence<char> x;", Array(Int(8, signed=False, spelling="char"))),
        ("double x[3][4];", Array(Array(Float(64, "double"), 4), 3)),
        ("sequence<sequence<long, 2>> x;", Array(Array(Int(32, spelling="long"), maximum=2))),
        ("sequence<long, (8 >> 1)> x;", Array(Int(32, spelling="long"), maximum=4)),
        ("map<string, long, 5> x;", Map(String("utf-8", "string"), Int(32, spelling="long"), 5)),
        ("@optional long x;", Optional(Int(32, spelling="long"))),
        ("@optional(FALSE) long x;", Int(32, spelling="long")),
        ("sequence<S> x;", Array(Ref("S"))),
    ],
)
def test_types(text, type_):
    assert one(text) == type_


def test_names_hide_words_of_idl_4():
    assert fields("typedef string uint8; struct S { uint8 x; };")["x"].type == String("utf-8", "string")


def test_a_union_is_a_struct_of_two_fields():
    text = """enum E { A, B, C }; union U switch (@key E) { case A: case C: @id(7) long x; default: string y; };
        union V switch (char) { case 'a': octet z[2]; }; union W switch (boolean) { case TRUE: long one; };"""
    told, cases = schema(text).types["U"].fields
    assert told == Field("_d", Ref("E"), 0, options=(("key", True),))
    x, y = Field("x", Int(32, spelling="long"), 7), Field("y", String("utf-8", "string"), 8)
    assert cases == Field("_u", Union("U::_u", (x, y), discriminator="_d", labels=((0, 2), ()), default=1))
    assert schema(text).types["V"].fields[1].type.labels == ((97,),)
    assert schema(text).types["W"].fields[1].type == Union("W::_u", (Field("one", Int(32, spelling="long"), 1),), None, "_d", ((1,),))


def test_ids_of_members():
    """DDS-XTypes 1.3, 7.3.1.2.1.1; the hash of `color` is the example that it gives."""
    text = """struct A { long x; @id(10) long b, c; @hashid long color; @hashid("color") long d0; };
        @autoid struct B { long color; @id(1) long e; }; @autoid(SEQUENTIAL) struct F { long color; };
        @autoid(HASH) module M { struct D { long color; }; }; struct G : F { long h; };"""
    with pytest.raises(SchemaError, match="two members have the id 10"):
        schema(text)
    types = schema(text.replace("b, c;", "b; long c;").replace('@hashid("color") long d0;', "")).types
    ids = {name: [field.number for field in struct.fields] for name, struct in types.items()}
    assert ids == {"A": [0, 10, 11, 0x0FA5DD70], "B": [0x0FA5DD70, 1], "F": [0], "M::D": [0x0FA5DD70], "G": [0, 1]}


def test_annotations_of_structs_and_members():
    text = """const long LIMIT = 3; enum E { P, @default_literal Q };
        @mutable @nested struct S {
          @key @must_understand @external long a; @range(min=1, max=LIMIT * 2) @default(LIMIT) long b; @unit("m") double c; E d;
          @default(value=P) E k; @min(0.5) @company::unknown(x=1, y="z") float f; @verbatim(language="comment", text="one" " line") long g;
          @default(1) double h; @default("(1, 2)") sequence<octet> i; @default("(1, 2.5)") sequence<double> j; };
        @extensibility(APPENDABLE) struct T { long a; };"""
    found = fields(text)
    assert found["a"].options == (("external", True), ("key", True), ("must_understand", True))
    assert (found["b"].options, found["b"].default) == ((("max", 6), ("min", 1)), 3)
    assert found["c"].unit == "m"
    assert (found["d"].default, found["k"].default) == (1, 0)
    assert found["f"].options == (("min", 0.5),)
    assert found["g"].doc == "one line"
    assert [found[name].default for name in "hi"] == [1.0, b"\x01\x02"]
    assert found["j"].options == (("default", "[1, 2.5]"),)
    assert schema(text).types["S"].options == (("extensibility", "mutable"), ("nested", True))
    assert schema(text).types["T"].options == (("extensibility", "appendable"),)


def test_values_of_enums():
    assert schema("enum E { A, @value(5) B, C };").types["E"] == Enum("E", (("A", 0), ("B", 5), ("C", 6)))


def test_constants():
    found = schema("module M { enum E { X, Y }; const E A = Y; const char B = 'b'; const wstring C = L\"\\u20ac\"; };").constants
    assert found["M::A"] == NamedConstant("M::A", Ref("M::E"), 1)
    assert (found["M::B"].value, found["M::C"].value) == (98, "€")
    assert schema("module S_Constants { const long A = 1; }; struct S { long x; };").types["S"].constants == (
        NamedConstant("A", Int(32, spelling="long"), 1),
    )


def test_base_members_come_first():
    text = "struct A { long x; }; typedef A B; struct S : B { long y; }; struct T : S { };"
    assert [field.name for field in schema(text).types["T"].fields] == ["x", "y"]


def test_interfaces_are_scopes_of_types():
    text = """interface I; abstract interface J { struct A { long x; }; void f(in A a1) raises (K::E); attribute long b; };
        interface I : J { typedef sequence<A> B; exception E { long y; }; struct C { B c1; long m[N]; }; }; const long N = 2;
        valuetype V : truncatable W supports I { public long z; private I i1; factory make(in long a2); struct D { long w; }; };
        valuetype Box sequence<long>; native Cookie; typeid I "x"; import ::M; component C0 { provides I a; };"""
    with pytest.raises(SchemaError, match="there is no `N`"):
        schema(text)
    text = "const long N = 2; valuetype W { public long u; };" + text.replace("const long N = 2;", "")
    assert set(schema(text).types) == {"J::A", "I::C", "V::D"}


@pytest.mark.parametrize(
    "text",
    [
        "any x;",
        "Object x;",
        "fixed<5, 2> x;",
        "long double x;",
        "I x;",
        "sequence<I> x;",
        "Cookie x;",
        "map<long, T> x;",
        "sequence<Q, 2> x[3];",
        "@optional V x;",
        "Flags x;",
    ],
)
def test_what_has_no_model_is_left_out(text):
    before = """interface I { }; native Cookie; typedef any T; struct Q { T y; }; union V switch (long) { case 1: Q z; };
        bitmask Flags { A, B }; const fixed F = 1.5d; struct Fine { long x; };"""
    found = parse(Source("a.idl", f"{before} struct S {{ {text} }}; struct U {{ sequence<S> s1; }};"), load_from())
    assert set(found.types) == {"Fine"}
    assert {"S", "U", "Q", "V"} <= found.left_out.keys()
    assert all(each.code == "unsupported" and each.span for each in found.left_out.values())


def test_asking_for_what_is_left_out_says_why():
    with pytest.raises(SchemaError, match="cannot be represented: it needs `any`"):
        rj.Decoder.of("S", encoding="cdr", schema={"a.idl": "struct S { any x; };"})


def test_bounds_of_enums_and_maps():
    found = schema("@bit_bound(8) enum Small { X, Y }; struct S { map<long, string, 4> m; };").types
    assert found["Small"].bits == 8
    assert found["S"].fields[0].type.maximum == 4


def test_names_in_modules_of_rosidl_are_free():
    text = """module p { module msg { struct String { string map; p::msg::Point point; uint8 default; }; struct Point { long p; }; }; };"""
    with pytest.raises(SchemaError, match="there is no `p::msg::Point`"):
        schema(text)
    text = """module p { module msg { struct Point { long p; }; struct String { string map; p::msg::Point point; uint8 default; }; }; };"""
    assert [field.name for field in schema(text).types["p::msg::String"].fields] == ["map", "point", "default"]


def test_the_dummy_member_of_rosidl_stays():
    """Its byte is on the wire."""
    (field,) = schema("struct S { uint8 structure_needs_at_least_one_member; };").types["S"].fields
    assert field.type == Int(8, signed=False, spelling="uint8")


def test_includes():
    files = {
        "x/a.idl": '#include "b.idl"\n#include <c.idl>',
        "x/b.idl": "struct B { long x; };",
        "openrtm/c.idl": '#include "../x/b.idl"\nstruct C { B y; };',
    }
    found = schema('#include "x/a.idl"\n#define FILE "x/b.idl"\n#include FILE\nstruct S { C z; };', **files)
    assert set(found.types) == {"B", "C", "S"}
    assert found.sources == ("a.idl", "x/a.idl", "x/b.idl", "openrtm/c.idl")
    assert found.types["C"].span.source.name == "openrtm/c.idl"


def test_what_corba_declares_by_itself():
    text = """#ifndef __OMNIIDL__
        #error
        #endif
        module CORBA { typedef sequence<TypeCode> Codes; struct A { long x; }; }; struct S { CORBA::A y; }; struct T { CORBA::Codes y; };"""
    assert set(schema(text).types) == {"CORBA::A", "S"}


def test_spans():
    found = schema("#define NAME x\nstruct S {\n  long NAME;\n};").types["S"]
    assert (str(found.span), str(found.fields[0].span)) == ("a.idl:2:8", "a.idl:3:8")


def test_a_byte_order_mark_and_line_ends():
    assert set(schema("\ufeffstruct S {\r\n  long x; // note\r\n};\r\n#if 1\r\nstruct T { long y; };\r\n#endif\r\n").types) == {"S", "T"}
