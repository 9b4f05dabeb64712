"""What is strict, what is lenient and by which name, and what cannot be encoded."""

from __future__ import annotations

import pytest

from rosetta_jit import Decoder
from rosetta_jit.errors import DecodeError, SchemaError
from rosetta_jit.frameworks.base import Choices
from rosetta_jit.frameworks.installed import installed
from rosetta_jit.frameworks.lcm.encoding import encode_type
from rosetta_jit.frameworks.lcm.idl import parse
from rosetta_jit.source import Source
from rosetta_jit.wire.printer import show_encoding
from tests.frameworks.lcm.lcm_files import WRONG, nothing
from tests.golden import check_golden

TEXT = """package p;

struct inner_t { int8_t n; string s[n]; }

struct t
{
    int16_t n;
    boolean flag;
    byte blob[n];
    double grid[2][n][3];
    inner_t inner;
    inner_t inners[n];
    node_t node;
}

struct node_t { int8_t n; node_t children[n]; }
"""


def encoding(text, name, *lenient):
    schema = parse(Source("a.lcm", text), nothing)
    return encode_type(schema.types[name], schema, "lcm", Choices(lenient=frozenset(lenient)))


def test_codec():
    check_golden(WRONG / "t.codec", show_encoding(encoding(TEXT, "p.t")))


REFUSED = {
    "an array of arrays": "struct n { int8_t k; n a[k][2]; }",
    "elements that contain them": "struct n { int8_t k; n a[k]; } struct e { n a; } struct t { e a[2]; }",
}


@pytest.mark.parametrize("name", REFUSED)
def test_recursive_structs_deep_in_elements_are_refused(name):
    text = REFUSED[name]
    with pytest.raises(SchemaError, match=r"error\[recursion\].*\n --> a.lcm:1:"):
        encoding(text, "t" if "struct t" in text else "n")


BOOLEANS = "struct t { boolean a; boolean b[3]; }"


def decoder(*lenient):
    return Decoder.of("t", encoding="lcm", schema={"a.lcm": BOOLEANS}, backend="python", lenient=lenient)


def message(text):
    return bytes.fromhex(f"{decoder().holder_type.get_hash():016x}{text}")


@pytest.mark.parametrize(("text", "kind"), [("01010002", "constant"), ("0101000100", "trailing")])
def test_strict(text, kind):
    with pytest.raises(DecodeError, match=kind):
        decoder()(message(text))


LENIENT = installed()["lcm"].leniencies.get("lcm", {})


@pytest.mark.parametrize(
    ("name", "text", "values"), [("bool", "ff020080", [True, False, True]), ("trailing", "0100000102", [False, False, True])]
)
def test_lenient(name, text, values):
    if name not in LENIENT:
        pytest.skip("the table of frameworks does not offer this leniency")
    found = decoder(name)(message(text))
    assert (found.a, found.b.tolist()) == (True, values)
    assert found.encode()[8:] == bytes([1, *values])
