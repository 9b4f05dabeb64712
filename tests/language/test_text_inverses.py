"""Texts in rules for both directions, and mistakes in rules that compute texts."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.language.texts import BACKENDS, HEAD, SCHEMAS

FILES = {
    "w.idl": """struct w {
  string id; long long n; double x; octet raw[8]; sequence<octet> data; long long at; string host; string level;
};""",
    "h.proto": """syntax = "proto2";
message H { required int64 id = 1; required string n = 2; required string x = 3; required string name = 4; required string data = 5;
            required string at = 6; required string host = 7; required double level = 8; }""",
    "m.mapping": """import "w.idl"
import "h.proto"
data-holder: H
wire-schema: w
rules:
  .id <-> integer(behind(.id, "id-"))
  .n <-> text(.n * 2)
  .x <-> text(.x)
  .name <-> text(until_nul(.raw), "latin-1")
  .data <-> text(.data, "utf-16le")
  .at <-> iso8601(.at)
  .host <-> "ros://" + .host + "/"
  .level <-> number(.level)
""",
}
GOOD = {
    "id": -17,
    "n": "-6",
    "x": "0.1",
    "name": "Zoë",
    "data": "a€😀",
    "at": "2026-11-21T10:08:42.500Z",
    "host": "ros://pc/",
    "level": 1e-7,
}


@pytest.mark.parametrize("backend", BACKENDS)
def test_both_directions(backend):
    decode = rj.Decoder("m.mapping", schema=FILES, encoding="cdr-giop", backend=backend)
    encode = rj.Encoder("m.mapping", schema=FILES, encoding="cdr-giop", backend=backend)
    read = rj.Decoder.of("w", schema=FILES, imports=["w.idl"], encoding="cdr-giop", backend="interpreter")
    message = encode(decode.holder_type.from_dict(GOOD))
    assert decode(message).to_dict() == GOOD
    wire = read(message).to_dict()
    assert (wire["id"], wire["n"], wire["x"], wire["host"], wire["level"]) == ("id--17", -3, 0.1, "pc", "1e-07")
    assert bytes(wire["raw"]) == "Zoë".encode("latin-1").ljust(8, b"\0")
    assert bytes(wire["data"]) == "a€😀".encode("utf-16le")
    assert wire["at"] == 1795255722500000000
    for wrong, kind in [
        ({"host": "http://pc/"}, "text"),
        ({"host": "ros:///"[:6]}, "text"),
        ({"n": "5"}, "range"),
        ({"n": "x"}, "text"),
        ({"x": "1e999"}, "range"),
        ({"name": "€"}, "text"),
        ({"name": "longer than 8"}, "length"),
        ({"at": "today"}, "text"),
    ]:
        with pytest.raises(rj.EncodeError) as error:
            encode(decode.holder_type.from_dict({**GOOD, **wrong}))
        assert error.value.kind == kind, wrong


@pytest.mark.parametrize("value", ["lower(.s)", "strip(.s)", 'part(.s, ",", 0)', 'replace(.s, "a", "b")', ".s + .t"])
def test_what_cannot_be_turned_round(value):
    text = HEAD + f"rules:\n  .s <-> {value}\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Encoder("m.mapping", schema={**SCHEMAS, "m.mapping": text}, encoding="yarp4", backend="interpreter")
    assert {problem.code for problem in error.value.diagnostics} & {"no-inverse", "several-fields"}


@pytest.mark.parametrize(
    ("rule", "code"),
    [
        (".s = lower(.i)", "text-needed"),
        (".s = .s + .i", "text-needed"),
        (".s = .s + .b", "text-and-bytes"),
        (".s = part(.s, .t, 0)", "quoted-text"),
        ('.s = part(.s, "", 0)', "empty-text"),
        ('.s = part(.s, ",", .x)', "integer-needed"),
        ('.s = strip(.s, "é")', "not-ascii"),
        ('.s = text(.b, "ebcdic")', "unknown-encoding"),
        (".b = bytes(.s, .t)", "unknown-encoding"),
        (".b = padded(.s, .i)", "written-size"),
        (".b = padded(.s, 100000)", "written-size"),
        (".s = text(.s)", "not-writable"),
        (".s = text(.x, 18)", "not-writable"),
        (".s = text(.i, 2)", "not-writable"),
        (".s = text()", "arguments"),
        (".s = lower(.s, .t)", "arguments"),
        (".n = .s", "type-clash"),
        (".n = lower(.s)", "type-clash"),
        (".n = number(.s)", "lossy-conversion"),
        (".s = seconds(.s)", "type-clash"),
        ('.ok = contains(.s, "' + "a" * 65 + '")', "long-text"),
        (".s = loewr(.s)", "unknown-function"),
        (".ok = .s == .i", "not-comparable"),
        ("len(.s) = 3", "length-fixed"),
    ],
)
def test_mistakes(rule, code):
    text = HEAD + f"unpack-rules:\n  {rule}\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema={**SCHEMAS, "m.mapping": text}, encoding="yarp4", backend="interpreter")
    assert code in {problem.code for problem in error.value.diagnostics if problem.span.source.line_column(problem.span.start)[0] == 6}


def test_nesting_is_bounded():
    value = "lower(" * 70 + ".s" + ")" * 70
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema={**SCHEMAS, "m.mapping": f"{HEAD}unpack-rules:\n  .s = {value}\n"}, encoding="yarp4")
    assert error.value.diagnostics[0].code == "nesting"


INVERSES = {
    "w.idl": "struct w { long n; double x; double at; };",
    "h.proto": 'syntax = "proto2"; message H { required string half = 1; required string whole = 2; required string rest = 3; }',
}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("relation", "left", "text", "wire"),
    [
        ("text(.n * 0.5)", ".x .at", "1.5", {"n": 3}),
        ("text(float64(.n))", ".x .at", "3.0", {"n": 3}),
        ("text(int32(.x))", ".n .at", "-3", {"x": -3.0}),
        ("text(seconds(.at))", ".n .x", "12", {"at": 12.0}),
    ],
)
def test_the_inverse_is_that_of_the_type_that_the_function_is_given(backend, relation, left, text, wire):
    """The field may have another one: an integer that is computed with floats is spelt as a float."""
    ignored = "".join(f"  ignore {name}\n" for name in left.split())
    rules = f"rules:\n  .half <-> {relation}\n{ignored}  default .whole\n  default .rest\n"
    files = {**INVERSES, "m.mapping": f'import "w.idl"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\n{rules}'}
    decode = rj.Decoder("m.mapping", schema=files, encoding="cdr-giop", backend=backend)
    encode = rj.Encoder("m.mapping", schema=files, encoding="cdr-giop", backend=backend)
    read = rj.Decoder.of("w", schema=files, imports=["w.idl"], encoding="cdr-giop", backend="interpreter")
    message = encode(decode.holder_type.from_dict({"half": text}))
    assert wire.items() <= read(message).to_dict().items()
    assert decode(message).half == text


def test_parts_of_a_float_as_texts():
    rules = "rules:\n  .whole <-> text(seconds(.at))\n  .rest <-> text(fraction(.at))\n  ignore .n\n  ignore .x\n  default .half\n"
    files = {**INVERSES, "m.mapping": f'import "w.idl"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\n{rules}'}
    encode = rj.Encoder("m.mapping", schema=files, encoding="cdr-giop", backend="interpreter")
    read = rj.Decoder.of("w", schema=files, imports=["w.idl"], encoding="cdr-giop", backend="interpreter")
    message = encode(encode.holder_type.from_dict({"whole": "12", "rest": "500000000"}))
    assert read(message).at == 12.5
