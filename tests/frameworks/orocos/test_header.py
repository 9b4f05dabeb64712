"""What a header means, and what it cannot do to us."""

from __future__ import annotations

import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.orocos import compiler
from rosetta_jit.frameworks.orocos.header import parse
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, NamedConstant, Ref, String, Struct
from rosetta_jit.source import Source
from tests.frameworks.orocos.headers import nothing, refusal, types

TEXT = String("octets", "std::string")
NUMBER = Int(32, True, "int")


def member(declaration):
    """The type of the last member of a struct."""
    return types(f"#include <array>\nenum Plain {{ A }};\nstruct T {{ int i; }};\nstruct S {{ {declaration}; }};")["S"].fields[-1].type


@pytest.mark.parametrize(
    ("declaration", "type_"),
    [
        ("bool m", Bool("bool")),
        ("char m", Int(8, True, "char")),
        ("int8_t m", Int(8, True, "signed char")),
        ("std::uint8_t m", Int(8, False, "unsigned char")),
        ("short int m", Int(16, True, "short")),
        ("unsigned m", Int(32, False, "unsigned int")),
        ("int64_t m", Int(64, True, "long")),
        ("long long m", Int(64, True, "long long")),
        ("std::size_t m", Int(64, False, "unsigned long")),
        ("char16_t m", Int(16, False, "char16_t")),
        ("const volatile float m", Float(32, "float")),
        ("double m = 1.5", Float(64, "double")),
        ('std::string m = "x"', TEXT),
        ("char m[32]", Bytes("char", 32)),
        ("unsigned char m[2][3]", Array(Bytes("unsigned char", 3), 2)),
        ("int8_t m[4]", Array(Int(8, True, "signed char"), 4)),
        ("std::vector<uint8_t> m", Bytes("unsigned char")),
        ("std::vector<char> m", Bytes("char")),
        ("std::vector<bool> m", Array(Bool("bool"))),
        ("double m[3][4]", Array(Array(Float(64, "double"), 4), 3)),
        ("std::array<std::array<int, 2>, 3> m", Array(Array(NUMBER, 2), 3)),
        ("std::vector<std::string> m[2]", Array(Array(TEXT), 2)),
        ("std::vector<std::vector<T>> m{}", Array(Array(Ref("T")))),
        ("T m", Ref("T")),
        ("struct T m", Ref("T")),
        ("Plain m", Ref("Plain")),
        ("typedef T Other; Other m", Ref("T")),
    ],
)
def test_members(declaration, type_):
    assert member(declaration) == type_


def test_namespaces_nesting_and_what_has_no_name():
    found = types(
        """
        namespace a { namespace { struct Inside { int i; }; } inline namespace v1 { struct New { int i; }; } }
        namespace a::b {
        extern "C" { struct Outer {
            struct Inner { short s; } inner;
            struct { int x; } place;
            enum { OFF, ON = 7 } mode;
            static int counted;
            void method() { undeclared(1); }
        }; }
        typedef struct { int i; } FromC;
        }
        """
    )
    assert found["a::b::Outer"] == Struct(
        "a::b::Outer",
        (
            Field("inner", Ref("a::b::Outer::Inner")),
            Field("place", Ref("a::b::Outer::place")),
            Field("mode", Ref("a::b::Outer::mode")),
        ),
    )
    assert found["a::b::Outer::mode"] == Enum("a::b::Outer::mode", (("OFF", 0), ("ON", 7)), closed=False)
    assert {"a::Inside", "a::v1::New", "a::b::FromC", "a::b::Outer::Inner", "a::b::Outer::place"} <= found.keys()


def test_members_of_bases_come_first():
    found = types("struct A { int a; }; struct B { int b; }; struct C : A { int c; }; struct D : C, B { int d; };")
    assert [field.name for field in found["D"].fields] == ["a", "c", "b", "d"]


def test_enums():
    schema = parse(Source("e.hpp", "enum class E : int8_t { LOW = -128 }; enum { LIMIT = 6 }; struct S { E e[2]; };"), nothing)
    assert schema.types["E"] == Enum("E", (("LOW", -128),), closed=False)
    assert schema.types["S"].fields == (Field("e", Array(Ref("E"), 2), options=(("underlying", "i8"),)),)
    assert schema.constants == {"LIMIT": NamedConstant("LIMIT", NUMBER, 6)}


def test_messages_that_are_no_structs():
    found = types("struct T { int i; }; enum class E : short { A }; typedef std::vector<T> Ts; using M = double[2]; typedef T Again;")
    assert found["double"].fields == (Field("data", Float(64, "double")),)
    assert found["std::vector<double>"].fields == (Field("data", Array(Float(64, "double"))),)
    assert found["std::vector<T>"].fields == found["Ts"].fields == (Field("data", Array(Ref("T"))),)
    assert found["std::vector<E>"].fields == (Field("data", Array(Ref("E")), options=(("underlying", "i16"),)),)
    assert found["M"].fields == (Field("data", Array(Float(64, "double"), 2)),)
    assert found["Again"] == Struct("Again", found["T"].fields)


def test_documentation_and_places():
    struct = types("/** What it\n * is.\n */\nstruct Über { int ä; //!< after\n/// One.\nint b; };")["Über"]
    assert struct.doc == "What it\nis."
    assert [field.doc for field in struct.fields] == ["after", "One."]
    assert [field.span.source.text[field.span.start : field.span.end] for field in struct.fields] == ["ä", "b"]


FILES = {
    "main.hpp": '#include "a/one.hpp"\n#include <b/two.hpp>\n#include "a/one.hpp"\nstruct M { One one; Two two; };',
    "a/one.hpp": """
        #pragma once
        #include "beside.hpp"
        struct Bad { Bad* next; };
        struct Holds { std::vector<Bad> bad; };
        struct One { Beside x; };
        """,
    "a/beside.hpp": "#pragma once\n#include <vector>\nstruct Beside { int i; };",
    "b/two.hpp": """
        #ifndef TWO
        #define TWO
        #include <a/beside.hpp>
        #ifdef NEVER
        #include <not/there.hpp>
        #endif
        struct Two { Beside y; };
        #endif
        """,
}


def load(name):
    return Source(f"/somewhere/{name}", FILES[name]) if name in FILES else None


def test_includes():
    schema = parse(Source("main.hpp", FILES["main.hpp"]), load)
    assert {"M", "One", "Two", "Beside"} <= schema.types.keys()
    assert "Bad" not in schema.types
    assert "Holds" not in schema.types
    assert schema.types["Two"].span.source.name == "/somewhere/b/two.hpp"
    assert set(schema.sources) == {"main.hpp", *(f"/somewhere/{name}" for name in FILES if name != "main.hpp")}


@pytest.mark.parametrize(
    "name",
    ["/etc/passwd", "../../../etc/passwd", "/dev/zero", "~/.profile", "/proc/self/environ", "stdio.h/../vector", "C:\\x", "gone.hpp"],
)
def test_no_file_of_the_machine_is_read(name, tmp_path):
    for text in (f'#include "{name}"', f"#include <{name}>", f'#define F "{name}"\n#include F', f'%:include "{name}"'):
        with pytest.raises(SchemaError) as caught:
            types(text)
        assert "root" not in str(caught.value)
        assert caught.value.diagnostics[0].code == "missing-file"


def test_a_header_on_disk_is_no_include_of_another(tmp_path):
    real = tmp_path / "real.hpp"
    real.write_text("struct Real { int i; };")
    with pytest.raises(SchemaError, match="there is no file"):
        types(f'#include "{real}"')


BOMBS = {
    "macros": "\n".join(["#define M0 int", *(f"#define M{n} M{n - 1} M{n - 1}" for n in range(1, 40)), "struct A { M39 x; };"]),
    "templates": """template <int A, int B> struct T { T<A - 1, B * 2> x; T<A - 1, B * 2 + 1> y; };
        template <int B> struct T<0, B> { int i; }; struct S { T<40, 0> t; };""",
    "constexpr": "constexpr int f(int n) { return n < 2 ? n : f(n - 1) + f(n - 2); } struct A { int x[f(60)]; };",
    "structs": "struct S0 { int a; };" + "".join(f"struct S{n} {{ S{n - 1} a, b; }};" for n in range(1, 31)),
    "bases": "struct S0 { int a0; };" + "".join(f"struct S{n} : S{n - 1} {{ int a{n}; }};" for n in range(1, 3000)),
    "braces": "struct A {" * 5000,
    "parentheses": "int " + "(" * 50000 + "x" + ")" * 50000 + ";",
    "sum": "struct A { int x[" + "+".join(["1"] * 100000) + "]; };",
    "namespaces": "namespace " + "::".join(["n"] * 20000) + " { struct A { int i; }; }",
    "vectors": "#include <vector>\nstruct A { " + "std::vector<" * 3000 + "int" + ">" * 3000 + " x; };",
    "dimensions": "struct A { int x" + "[1]" * 3000 + "; };",
    "pointers": "struct A { int " + "*" * 50000 + " x; };",
    "includes": '#include "self.hpp"\n#include "self.hpp"\n',
    "surrogates": "struct A { int \ud800; };",
    "zeros": "struct A { int\0 x; };",
    "empty": "",
}


@pytest.mark.parametrize("name", BOMBS)
def test_bombs_are_refused_or_read(name, monkeypatch):
    monkeypatch.setitem(compiler.MOST, "seconds", 1)
    text, begin = BOMBS[name], time.process_time()
    refusal(parse, Source("bomb.hpp", text), lambda asked: Source("self.hpp", text) if asked == "self.hpp" else None)
    assert time.process_time() - begin < 30


WORDS = [
    "struct",
    "enum",
    "class",
    "A",
    "B",
    "{",
    "}",
    ";",
    "int",
    "x",
    "[",
    "3",
    "]",
    ":",
    "<",
    ">",
    "std::vector",
    "::",
    "template",
    "(",
    ")",
    "*",
    "=",
    "public",
    "typedef",
    "#include",
    "\n",
]


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.sampled_from(WORDS), max_size=40))
def test_any_words_are_read_or_refused(words):
    refusal(types, " ".join(words))
