"""Whatever a text or a message holds, a schema, a holder or one of our errors comes out, and soon."""

from __future__ import annotations

import itertools
import json
import time
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosetta_jit import Decoder
from rosetta_jit.errors import DecodeError, SchemaError
from rosetta_jit.frameworks.base import Choices
from rosetta_jit.frameworks.lcm.encoding import encode_type
from rosetta_jit.frameworks.lcm.idl import parse
from rosetta_jit.source import Source
from tests.frameworks.lcm.lcm_files import VECTORS, nothing

BIG = 10_000


def outcome(text, load=nothing):
    try:
        parse(Source("a.lcm", text), load)
    except SchemaError as error:
        return str(error)
    return ""


def struct(name, *fields):
    return f"struct {name} {{ {' '.join(fields)} }}\n"


def each(line, *, count=BIG):
    return "".join(line.format(number) for number in range(count))


HOSTILE = {
    "braces": "struct t { " * BIG,
    "glued braces": "{" * BIG,
    "brackets": "struct t { int8_t a" + "[" * BIG,
    "dimensions": "struct t { int8_t a" + "[1]" * BIG + "; }",
    "comments opened": "/*" * BIG,
    "comments": "/**/" * BIG,
    "quotes": "\"'\\" * BIG,
    "long name": "struct " + "a" * BIG + " { }",
    "dots": "package " + "a." * BIG + "a;",
    "long number": "struct t { const int64_t A = " + "9" * BIG + "; }",
    "long real": "struct t { const double A = 1e" + "9" * BIG + "; }",
    "long size": "struct t { int8_t a[" + "9" * BIG + "]; }",
    "same name": "struct t { " + "int8_t a; " * BIG + "}",
    "same type": "struct t { }\n" * BIG,
    "unknown types": "struct t { " + each("x{}_t a{}; ".replace("{}", "{0}")) + "}",
    "unknown sizes": "struct t { " + each("int8_t a{0}[n{0}]; ") + "}",
    "words of an enum": "enum e { " + each("A{0}, ") + "}",
    "same words": "enum e { " + "A, " * BIG + "}",
    "constants": "struct t { " + each("const int8_t a{0} = {0}; ") + "}",
    "nested": "struct t { " + "struct u { " * BIG,
    "chain": each("struct t{0} {{ int8_t a; }}\n", count=5_000),
    "circle": "".join(struct(f"t{n}", f"t{(n + 1) % 5_000} a;") for n in range(5_000)),
    "semicolons": ";" * BIG,
    "control characters": "\0\x01\x7f" * BIG,
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_texts(name):
    begin = time.process_time()
    report = outcome(HOSTILE[name])
    assert time.process_time() - begin < 30
    assert len(report) < 200_000


def chain(length):
    return "".join(struct(f"t{n}", f"t{n + 1} a;") for n in range(length)) + struct(f"t{length}", "int8_t a;")


def doubling(length):
    return "".join(struct(f"t{n}", f"t{n + 1} a; t{n + 1} b;") for n in range(length)) + struct(f"t{length}", "int8_t a;")


def crosswise(count):
    return "".join(struct(f"t{n}", "int8_t n;", *(f"t{m} a{m}[n];" for m in range(count))) for n in range(count))


def ring(count):
    return "".join(struct(f"t{n}", "int8_t n;", f"t{(n + 1) % count} a[n];") for n in range(count))


WIDE = struct("t0", each("int8_t a{0}; ", count=70_000))


@pytest.mark.parametrize(
    "text", [chain(1_000), doubling(60), crosswise(40), ring(1_000), WIDE], ids=["chain", "doubling", "crosswise", "ring", "wide"]
)
def test_types_that_unfold_without_end(text):
    schema = parse(Source("a.lcm", text), nothing)
    begin = time.process_time()
    with pytest.raises(SchemaError):
        encode_type(schema.types["t0"], schema, "lcm", Choices())
    assert time.process_time() - begin < 30


def test_structs_that_contain_each_other_crosswise_have_a_fingerprint():
    schema = parse(Source("a.lcm", crosswise(6)), nothing)
    assert encode_type(schema.types["t0"], schema, "lcm", Choices()).nested


def test_a_search_path_that_has_everything():
    numbers = itertools.count()

    def load(path):
        number = next(numbers)
        return Source(path, struct(path.rpartition("/")[2].removesuffix(".lcm"), f"x{number}_t a;"))

    assert "unknown-type" in outcome(struct("t", "a_t a;"), load)


@settings(max_examples=100, deadline=None)
@given(st.text(max_size=60))
def test_any_text(text):
    outcome(text)
    outcome(f"struct t {{ {text} }}")
    outcome(f"enum e {{ {text} }}")


RECORDS = json.loads((VECTORS / "records.json").read_text())
DECODERS = {}


def decoder(name):
    if name not in DECODERS:
        DECODERS[name] = Decoder.of(name, encoding="lcm", backend="python")
    return DECODERS[name]


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_records_with_bytes_changed(data):
    record = data.draw(st.sampled_from(RECORDS))
    changed = bytearray.fromhex(record["bytes"])
    for _ in range(data.draw(st.integers(1, 3))):
        changed[data.draw(st.integers(8, max(8, len(changed) - 1))) % len(changed)] = data.draw(st.sampled_from((0, 1, 2, 127, 128, 255)))
    with suppress(DecodeError):
        decoder(record["type"])(bytes(changed))


def test_every_record_cut_short_is_refused():
    for record in RECORDS:
        data = bytes.fromhex(record["bytes"])
        for end in range(0, len(data), max(1, len(data) // 30)):
            with pytest.raises(DecodeError):
                decoder(record["type"])(data[:end])


def test_every_record_with_bytes_behind_it_is_refused():
    for record in RECORDS:
        with pytest.raises(DecodeError):
            decoder(record["type"])(bytes.fromhex(record["bytes"]) + b"\0")
