"""The field that counts an array of LCM is the array's length: in the check that all elements are set, and that all fields are read."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

FILES = {
    "p.lcm": """package p;
struct row { int32_t n; int32_t m; double w[m][n]; }
struct all { int16_t k; int64_t h; row parts[k]; byte raw[h]; double v[h]; double other; }""",
    "q.proto": """syntax = "proto3"; package q;
message Cells { repeated double c = 1; } message Row { repeated Cells w = 1; }
message All { repeated Row parts = 1; bytes raw = 2; repeated double v = 3; double other = 4; }""",
    "f.bottle-schema": '"f" (("n" :int) ("v" (:list :double) (:length n)) ("m" :int) ("w" (:list :double) (:length (* n m))))',
    "g.proto": 'syntax = "proto3"; package q; message F { repeated double v = 1; repeated double w = 2; }',
}
LCM = 'import "p.lcm"\nimport "q.proto"\ndata-holder: q.All\nwire-schema: p.all\nunpack-rules:\n'
BOTTLE = 'import "f.bottle-schema"\nimport "g.proto"\ndata-holder: q.F\nwire-schema: f\nunpack-rules:\n'
VALUE = {
    "k": 2,
    "h": 3,
    "parts": [{"n": 2, "m": 1, "w": [[1.0, 2.0]]}, {"n": 0, "m": 0, "w": []}],
    "raw": b"abc",
    "v": [5.0, 6.0, 7.0],
    "other": 8.0,
}


def decoder(rules, head=LCM, **options):
    return rj.Decoder("m.mapping", schema={**FILES, "m.mapping": head + rules}, backend="interpreter", **options)


def loop(length, stop):
    rest = "  default .parts\n  default .raw\n  .other = .other\n"
    return f"  len(.v) = {length}\n  for i from 0 to {stop}\n    .v[i] = .v[i]\n  end\n{rest}"


def warnings(found):
    return [(each.code, each.message.split("`")[1]) for each in found.mapping.warnings]


def message():
    encode = rj.Encoder.of("p.all", schema=FILES, imports=["p.lcm"], backend="interpreter")
    return bytes(encode(encode.holder_type.from_dict(VALUE)))


@pytest.mark.parametrize(("length", "stop"), [(".h", "len(.v)"), ("len(.v)", ".h"), ("len(.raw)", "len(.v)"), (".h", "len(.raw)")])
def test_one_length(length, stop):
    found = decoder(loop(length, stop))
    assert list(found(message()).v) == VALUE["v"]


@pytest.mark.parametrize(("length", "stop"), [(".k", "len(.v)"), ("len(.parts)", "len(.v)"), (".h", "len(.parts)")])
def test_other_lengths(length, stop):
    with pytest.raises(rj.MappingError) as error:
        decoder(loop(length, stop))
    assert [each.code for each in error.value.diagnostics] == ["coverage"]


def test_arrays_in_elements_and_of_two_dimensions():
    rules = """  len(.parts) = .k
  for i from 0 to len(.parts)
    len(.parts[i].w) = .parts[i].m
    for j from 0 to len(.parts[i].w)
      len(.parts[i].w[j].c) = len(.parts[i].w[j])
      for l from 0 to .parts[i].n
        .parts[i].w[j].c[l] = .parts[i].w[j][l]
      end
    end
  end
  .raw = .raw
  .v = .v
  .other = .other
"""
    found = decoder(rules)
    assert warnings(found) == []
    assert found(message()).to_dict()["parts"] == [{"w": [{"c": [1.0, 2.0]}]}, {"w": []}]


def test_what_counts_is_read_with_what_it_counts():
    rules = "  default .parts\n  default .v\n  .raw = .raw\n  .other = .other\n"
    assert warnings(decoder(rules)) == [("never-read", ".k"), ("never-read", ".parts"), ("never-read", ".v")]
    assert warnings(decoder(rules + "  ignore .parts\n  ignore .v\n")) == []


def test_a_holder_may_disagree_with_its_count():
    """Only messages in which the two differ are refused."""
    head = 'import "p.lcm"\nimport "q.proto"\ndata-holder: p.all\nwire-schema: q.All\npack-rules:\n'
    rules = "  len(.v) = .h\n  for i from 0 to len(.v)\n    .v[i] = .v[i]\n  end\n  default .parts\n  default .raw\n  .other = .other\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Encoder("m.mapping", schema={**FILES, "m.mapping": head + rules}, backend="interpreter")
    assert [each.code for each in error.value.diagnostics] == ["coverage"]


def test_lengths_that_a_bottle_schema_tells():
    rules = "  len(.v) = .n\n  for i from 0 to len(.v)\n    .v[i] = .v[i]\n  end\n  .w = .w\n"
    assert warnings(decoder(rules, BOTTLE, encoding="yarp3")) == [("never-read", ".m")]
