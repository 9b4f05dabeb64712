"""What a typelib registry means, and that it means what the header does."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosetta_jit.frameworks.base import Choices
from rosetta_jit.frameworks.orocos.encoding import encode_type
from rosetta_jit.frameworks.orocos.typelib import cxx_name, parse
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Ref, Schema, String, Struct
from rosetta_jit.source import Source
from tests.frameworks.orocos.headers import nothing, refusal, types

TEXT = (Path(__file__).parents[2] / "vectors" / "orocos" / "base.tlb").read_text()

HEADER = """
#include <string>
#include <vector>
namespace base {
enum Mode { OFF = -1, ON = 1 };
struct Joint { int id; float pos; bool ok; };
struct __attribute__((packed)) Packed { unsigned char letter; double number; };
struct State {
    int64_t time; std::vector<std::string> names; std::vector<Joint> joints[2]; float matrix[2][3];
    Packed packed; Mode mode; Joint one; unsigned char few[3];
};
}
"""


def registry(text=TEXT):
    return parse(Source("base.tlb", text), nothing).types


def test_reads_every_kind_of_type():
    found = registry()
    joint = (Field("id", Int(32, True, "int32_t")), Field("pos", Float(32, "float")), Field("ok", Bool("bool")))
    assert found["base::Joint"] == Struct("base::Joint", joint)
    assert found["base::SameJoint"] == Struct("base::SameJoint", joint)
    assert found["base::Joints"] == Struct("base::Joints", (Field("data", Array(Ref("base::Joint"))),))
    assert found["std::vector<base::Joint>"].fields == found["base::Joints"].fields
    assert found["int32_t[4]"].fields == (Field("data", Array(Int(32, True, "int32_t"), 4)),)
    assert found["base::Mode"] == Enum("base::Mode", (("OFF", -1), ("ON", 1)), closed=False)
    assert found["base::State"].fields == (
        Field("time", Int(64, True, "int64_t")),
        Field("names", Array(String("octets", "std::string"))),
        Field("joints", Array(Array(Ref("base::Joint")), 2)),
        Field("matrix", Array(Array(Float(32, "float"), 3), 2)),
        Field("packed", Ref("base::Packed")),
        Field("mode", Ref("base::Mode")),
        Field("one", Ref("base::Joint")),
        Field("few", Bytes("uint8_t", 3)),
    )


@pytest.mark.parametrize("encoding", ["rtt-mqueue", "typelib", "native"])
@pytest.mark.parametrize("name", ["base::Joint", "base::Packed", "base::State"])
def test_agrees_with_the_header(name, encoding):
    if name == "base::State" and encoding == "native":
        pytest.skip("it has containers")
    one, other = Schema(registry()), Schema(types(HEADER))
    assert encode_type(one.types[name], one, encoding, Choices()) == encode_type(other.types[name], other, encoding, Choices())


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("/double", "double"),
        ("/base/samples/Joints", "base::samples::Joints"),
        ("/std/vector</base/X>", "std::vector<base::X>"),
        ("/std/pair</a/B,/c/D>", "std::pair<a::B,c::D>"),
    ],
)
def test_names(name, expected):
    assert cxx_name(name) == expected


HOSTILE = {
    "laughs": '<!DOCTYPE t [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><typelib>&b;</typelib>',
    "external": '<!DOCTYPE t [<!ENTITY a SYSTEM "file:///etc/passwd">]><typelib>&a;</typelib>',
    "entity": "<typelib>&a;</typelib>",
    "deep": "<typelib>" + "<metadata>" * 100000,
    "elements": "<typelib>" + '<alias name="a" source="b"/>' * 200001 + "</typelib>",
    "aliases": "<typelib>" + "".join(f'<alias name="/a{n}" source="/a{n + 1}"/>' for n in range(3000)) + "</typelib>",
    "circle": '<typelib><alias name="/a" source="/b"/><alias name="/b" source="/a"/></typelib>',
    "array": '<typelib><array name="/a" of="/a" dimension="3"/></typelib>',
    "brackets": '<typelib><compound name="/a" size="8"><field name="x" type="/int' + "[1]" * 3000 + '" offset="0"/></compound></typelib>',
    "chain": "<typelib>"
    + "".join(f'<compound name="/a{n}" size="4"><field name="x" type="/a{n + 1}" offset="0"/></compound>' for n in range(3000))
    + '<compound name="/a3000" size="4"/></typelib>',
    "double": "<typelib>"
    + "".join(
        f'<compound name="/a{n}" size="{2**n}">'
        f'<field name="x" type="/a{n - 1}" offset="0"/><field name="y" type="/a{n - 1}" offset="{2 ** (n - 1)}"/></compound>'
        for n in range(1, 31)
    )
    + '<compound name="/a0" size="1"><field name="x" type="/bool" offset="0"/></compound></typelib>',
    "surrogate": '<typelib><alias name="\ud800" source="/int"/></typelib>',
    "encoding": '<?xml version="1.0" encoding="utf-16"?><typelib/>',
    "numbers": '<typelib><enum name="/e"><value symbol="a" value="' + "9" * 100000 + '"/></enum></typelib>',
    "negative": '<typelib><compound name="/a" size="-8"><field name="x" type="/int" offset="-4"/></compound></typelib>',
    "empty": "",
    "zero": "\0",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_registries_are_refused_or_read(name):
    report = refusal(registry, HOSTILE[name])
    if report is not None:
        assert "root:" not in report
        return
    schema = Schema(registry(HOSTILE[name]))
    for each in list(schema.types.values())[-5:]:
        if isinstance(each, Struct):
            refusal(encode_type, each, schema, "typelib", Choices())


@given(st.integers(0, len(TEXT) - 1), st.sampled_from(['"', "<", ">", "/", "x", "0", "&", "é", ""]), st.integers(0, 8))
def test_a_damaged_registry_is_read_or_refused(at, put, dropped):
    refusal(registry, TEXT[:at] + put + TEXT[at + dropped :])
