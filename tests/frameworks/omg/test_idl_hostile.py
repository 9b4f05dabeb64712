"""Whatever a text holds, a schema or a SchemaError comes out, and soon."""

from __future__ import annotations

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.omg.idl import parse
from rosetta_jit.source import Source
from tests.frameworks.omg.idl_files import AGREED, RJ, load_from

SOUP = [*(AGREED / "token_soup.txt").read_text().split(), "\n", "\n", "\n#if", "\n#endif\n", "\n#define", "\ud800"]
BIG, MANY = 10_000, 40_000
TEXTS = [path.read_text() for path in sorted(AGREED.glob("*.idl"))] + [RJ]


def outcome(text, load=None):
    try:
        parse(Source("a.idl", text), load or load_from())
    except SchemaError as error:
        return str(error)
    return ""


@settings(max_examples=300, deadline=None)
@given(st.lists(st.sampled_from(SOUP), max_size=60))
def test_token_soup(words):
    outcome(" ".join(words))


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_files_with_words_moved(data):
    words = data.draw(st.sampled_from(TEXTS)).split(" ")
    for _ in range(data.draw(st.integers(1, 4))):
        here, there = (data.draw(st.integers(0, len(words) - 1)) for _ in range(2))
        words[here], words[there] = words[there], words[here]
    outcome(" ".join(words))


@settings(max_examples=150, deadline=None)
@given(st.text(max_size=60))
def test_any_text(text):
    outcome(text)
    outcome(f'const string A = "{text}";')
    outcome(f"#if {text}\n#endif")


def chain(count, link):
    return "\n".join(link(index) for index in range(count))


def hostile(big):
    """Texts whose parts are repeated up to so many times."""
    return {
        "modules": "module M {" * big,
        "structs": "struct S { struct T { " * big,
        "sequences": "typedef " + "sequence<" * big,
        "parentheses": "const long A = " + "(" * big,
        "signs": "const long A = " + "-" * big + "1;",
        "sums": "const long A = 1" + "+1" * big + ";",
        "scopes": "typedef A" + "::A" * big + " T;",
        "conditions": "#if 1\n" * big,
        "parentheses in conditions": "#if " + "(" * big + "\n#endif",
        "sums in conditions": "#if 1" + "+1" * big + "\n#endif",
        "negations": "#if " + "!" * big + "1\n#endif",
        "comments opened again and again": "/*" * big,
        "quotes": '"\\' * big,
        "continued lines": "\\\n" * big,
        "long number": "const long A = " + "9" * big + ";",
        "long hexadecimal": "const long A = 0x" + "9" * big + ";",
        "long float": "const double A = " + "9" * big + ".0;",
        "great shift": "const long A = 1 << 4000000000000;",
        "great shift in a condition": "#if 1 << 4000000000000\n#endif",
        "powers": "const long A = " + "*".join(["18446744073709551615"] * 90) + ";",
        "powers in a condition": "#if " + "*".join(["18446744073709551615"] * 90) + "\n#endif",
        "long name": "struct " + "a" * big + " { long x; };",
        "long names": "module " + "a" * 500 + " {" + chain(5000, lambda i: f"struct {'b' * 500}{i} {{ long x; }};") + "};",
        "strings": "const string A = " + '"a" ' * big + ";",
        "wrong statements": "a " * big,
        "wrong statements that end": "a; " * big,
        "closing braces": "}; " * big,
        "unknown types": "struct S { " + "A a; " * (big // 10) + "};",
        "one name again and again": "struct S { " + "long a; " * (big // 10) + "};",
        "macros that double": chain(60, lambda i: f"#define M{i} M{i + 1} M{i + 1}") + "\nM0",
        "macros that double and vanish": chain(60, lambda i: f"#define M{i} M{i + 1} M{i + 1}") + "\n#define M60\nM0",
        "macros in conditions": chain(60, lambda i: f"#define M{i} M{i + 1} + M{i + 1}") + "\n#if M0\n#endif",
        "macros of one another": "#define A B\n#define B A\nstruct A { long x; };",
        "macro used again and again": "#define M " + "long x; " * (big // 8) + "\n" + "M\n" * (big // 8),
        "typedefs of arrays": "typedef long T0;\n" + chain(5000, lambda i: f"typedef T{i} T{i + 1}[2];"),
        "typedefs of typedefs": "typedef long T0;\n" + chain(5000, lambda i: f"typedef T{i} T{i + 1};"),
        "typedefs of structs": "struct T0 { long x; };\n" + chain(5000, lambda i: f"typedef T{i} T{i + 1};"),
        "typedefs of maps": "typedef map<long, long> T0;\n" + chain(5000, lambda i: f"typedef map<long, T{i}> T{i + 1};"),
        "dimensions": "typedef long T" + "[2]" * big + ";",
        "structs of structs": "struct T0 { long x; };\n" + chain(5000, lambda i: f"struct T{i + 1} {{ T{i} a, b; }};"),
        "inheritance": "struct T0 { long x0; };\n" + chain(big // 12, lambda i: f"struct T{i + 1} : T{i} {{ long x{i + 1}; }};"),
        "interfaces": "interface T0 { };\n" + chain(big // 12, lambda i: f"interface T{i + 1} : T{i} {{ typedef X Y; }};"),
        "interface of itself": "interface A; interface A : A { typedef B C; };",
        "many bases": chain(2000, lambda i: f"interface T{i} {{ }};")
        + "interface U : "
        + ", ".join(f"T{i}" for i in range(big // 20))
        + " { };",
        "labels": "union U switch (long) { " + chain(big // 2, lambda i: f"case {i}: long a{i};") + "};",
        "enumerators": "enum E { " + ", ".join(f"A{i}" for i in range(big // 2)) + " };",
        "defaults": "enum E { "
        + ", ".join(f"A{i}" for i in range(big // 8))
        + "}; struct S {"
        + chain(5000, lambda i: f"@default(A9) E x{i};")
        + "};",
        "list as a default": '@default(value="'
        + "(" * (big // 8)
        + '") struct S { @default(value="'
        + "(" * (big // 8)
        + '") sequence<long> x; };',
        "annotations": "@a " * big,
        "annotation arguments": "@a(" * big,
        "left out": "struct T0 { any x; };\n" + chain(5000, lambda i: f"struct T{i + 1} {{ sequence<T{i}> a; }};"),
        "lone surrogates": 'struct S { @hashid("\ud800") long x; @hashid(L"\\ud800") long y; string<"\ud800"> z; };',
        "skipped": "interface I { void f(" + "in long x, (" * big,
    }


@pytest.mark.parametrize("name", hostile(1))
def test_hostile_texts_end_in_time(name):
    ends_in_time(hostile(BIG)[name], 8)


@pytest.mark.campaign
@pytest.mark.parametrize("name", hostile(1))
def test_larger_hostile_texts_end_in_time(name):
    ends_in_time(hostile(MANY)[name], 30)


def ends_in_time(text, seconds):
    start = time.process_time()
    report = outcome(text)
    assert time.process_time() - start < seconds
    assert len(report) < 200_000


def test_a_chain_of_includes_does_not_recurse():
    def load(path):
        index = int(path)
        return Source(path, f'#include "{index + 1}"' if index < 1500 else "struct Last { long x; };")

    assert "Last" in parse(Source("root", '#include "0"\nstruct S { Last a; };'), load).types


def test_files_without_end():
    assert "too-many-files" in outcome('#include "0"', lambda path: Source(path, f'#include "{int(path) + 1}"'))


def test_files_that_include_each_other():
    texts = {"a": '#include "b"\nstruct A { long x; };', "b": '#include "a"\nstruct B { long x; };'}
    schema = parse(Source("a", texts["a"]), load_from(**texts))
    assert set(schema.types) == {"A", "B"}
    assert schema.sources == ("a", "b")
