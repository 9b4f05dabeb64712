"""Filters, and arrays made of others, in generated source: C, C++, Python and Lisp make what the library makes."""

from __future__ import annotations

import sys
import types

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of
from rosetta_jit.generate.build import generated
from tests.generate import cpp, lisp
from tests.generate.driver import answers, driver, expected, harmed, needs_gcc, write
from tests.generate.python import answer, source_of

FILES = {
    "m.bottle-schema": """"m" (("a" (:list :double)) ("n" (:list :int)) ("names" (:list :string)) ("steps" (:list :int))
("cells" (:list :int)) ("counts" (:list :int)) ("mask" :blob))""",
    "m.proto": """syntax = "proto2"; package lab;
message M { repeated double a = 1; repeated int32 n = 2; repeated string names = 3; repeated int64 ticks = 4; repeated int32 cells = 5;
  repeated bool flags = 6; required uint32 check = 7; }""",
    "m.mapping": """import "m.bottle-schema"
import "m.proto"
data-holder: lab.M
wire-schema: m
rules:
  .ticks <-> running_sums(.steps)
  .cells <-> repeated(.cells, .counts)
  .flags <-> bits(.mask)
unpack-rules:
  .a = .a where isfinite(.a[]) and .a[] < 2.0
  .n = .n where index() % 2 == 0
  .names = .names where .names[] != "off"
  .check = crc(.mask, "CRC-16/MODBUS")
pack-rules:
  ignore .check
  .a = .a where not isnan(.a[])
  .n = .n where .n[] > 0
  .names = .names
""",
}
REQUEST = request_of("decode", {"encoding": "yarp4", "schema": FILES}, mapping="m.mapping")
BOTH = ("decode", "encode")


@pytest.fixture(scope="module")
def programs():
    options = {"schema": FILES, "encoding": "yarp4"}
    return rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)


@pytest.fixture(scope="module")
def messages():
    of = rj.Encoder.of("m", schema=FILES, imports=["m.bottle-schema"], encoding="yarp4")
    full = {"a": [0.5, float("nan"), 3.0, float("-inf"), 1.0], "n": [1, 2, -3, 4, 5], "names": ["on", "off", "", "off", "x"]}
    full |= {"steps": [1, -5, 2**31 - 1], "cells": [-1, 0, 100], "counts": [2, 0, 3], "mask": b"\x01\xf0"}
    none = {"a": [], "n": [], "names": [], "steps": [], "cells": [], "counts": [], "mask": b""}
    good = [of(of.holder_type.from_dict(values)) for values in (none, full, {**full, "counts": [2, -1, 3]})]
    return [*good, *harmed(good, 4, "filters")]


@needs_gcc
@pytest.mark.campaign
def test_c_keeps_the_same(tmp_path, programs, messages):
    program = driver(tmp_path, write(tmp_path, generated(REQUEST, "c", BOTH, "unit")))
    assert answers(program, messages) == [expected(*programs, each) for each in messages]


@cpp.needs_cpp
@pytest.mark.campaign
def test_cpp_keeps_the_same(tmp_path, programs, messages):
    program = cpp.program(tmp_path, cpp.write(tmp_path, generated(REQUEST, "cpp", BOTH, "unit")))
    assert answers(program, messages) == [expected(*programs, each) for each in messages]


def test_python_keeps_the_same(monkeypatch, programs, messages):
    made = types.ModuleType("generated_unit")
    monkeypatch.setitem(sys.modules, made.__name__, made)
    exec(compile(source_of(REQUEST), "unit.py", "exec"), made.__dict__)  # noqa: S102 - what is under test
    assert [answer(made, each) for each in messages] == [expected(*programs, each) for each in messages]


@lisp.needs_sbcl
@pytest.mark.campaign
def test_lisp_keeps_the_same(tmp_path, programs, messages):
    (found,) = lisp.answers(tmp_path, [(REQUEST, messages)])
    assert found == lisp.expected(REQUEST, *programs, messages)
