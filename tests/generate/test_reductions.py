"""Reductions of the elements for which a condition holds, in generated source: each language computes what the library computes."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of
from tests.generate.test_random_relations import LANGUAGES, Case

FILES = {
    "m.bottle-schema": '"m" (("a" (:list :double)) ("n" (:list :int)) ("d" (:list :int)) ("names" (:list :string)) ("least" :double))',
    "m.proto": """syntax = "proto2"; package lab;
message M { repeated double a = 1; repeated int32 n = 2; repeated int32 d = 3; repeated string names = 4; required double least = 5;
  required double sum = 6; required double mean = 7; required int64 quotients = 8; required int64 on = 9; required bool any = 10;
  required bool all = 11; required int64 xor = 12; required int64 most = 13; required double other = 14; }""",
    "m.mapping": """import "m.bottle-schema"
import "m.proto"
data-holder: lab.M
wire-schema: m
rules:
  .a <-> .a
  .n <-> .n
  .d <-> .d
  .names <-> .names
  .least <-> min(.a[] where .a[] > .least)
  .on <-> count(.names[] == "on" where .names[] != "")
unpack-rules:
  .sum = sum(.a[] * 2 where .a[] == .a[])
  .mean = mean(.a[] where index() % 2 == 0)
  .quotients = sum(.n[] / .d[] where .d[] != 0)
  .any = any(.n[] % .d[] == 1 where .d[] != 0)
  .all = all(.n[] % .d[] == 1 where .d[] != 0)
  .xor = xor(.n[] where .n[] > 0)
  .most = max(.n[] where .d[] != 0)
  .other = sqrt(sum((.a[] - mean(.a[] where isfinite(.a[]))) * .a[] where isfinite(.a[])))
pack-rules:
  .least = min(.a[] where not isnan(.a[])) - 1.0
  reject "too many" when count(.n[] > 2 where .d[] != 0) > 2
""",
}
NAN, INFINITY = float("nan"), float("inf")
MESSAGES = [
    {"a": [1.5, NAN, 0.1, 0.2, 0.3, -7.0], "n": [7, 3, -5, 2], "d": [2, 0, 3, 2], "names": ["on", "", "off", "on"], "least": 0.0},
    {"a": [4.0, 2.0, 4.0], "n": [9, 9, 9], "d": [2, 4, 8], "names": ["", "on"], "least": 1.0},
    {"a": [4.0, 2.0], "n": [9], "d": [2], "names": [], "least": 4.0},
    {"a": [4.0, INFINITY], "n": [5, -3], "d": [0, 0], "names": [], "least": 1.0},
    {"a": [], "n": [], "d": [], "names": [], "least": 1.0},
    {"a": [4.0], "n": [1, 2], "d": [1], "names": [], "least": 1.0},
    {"a": [-0.0, 0.0, 5.0], "n": [1], "d": [1], "names": ["on"] * 9, "least": -1.0},
]


@pytest.fixture(scope="module")
def made() -> Case:
    options = {"schema": FILES, "encoding": "yarp4"}
    of = rj.Encoder.of("m", imports=["m.bottle-schema"], **options)
    messages = [bytes(of(of.holder_type.from_dict(values))) for values in MESSAGES]
    programs = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    return Case(request_of("decode", options, mapping="m.mapping"), programs, messages, "reductions")


@pytest.mark.parametrize("language", LANGUAGES)
def test_each_language_computes_the_same(language, made, tmp_path):
    language(made, tmp_path)
