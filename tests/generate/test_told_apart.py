"""Fields and types whose names have the same words are told apart: `a.b` and `a_b`, a text `s` and `s_start`, `a.b.T` and `a_b.T`."""

from __future__ import annotations

from typing import Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from tests.generate import cpp, driver
from tests.generate.python import answers_as_the_library, module

BOTH = ("decode", "encode")
ROS: dict[str, Any] = {
    "p/msg/O.msg": "A a\nAB a_b\nint32 a_b_x\nint32 x\nint32 x_\nstring s\nint64 s_start\nint64 s_count\n"
    "float64[3] q\nfloat64 q_0\nR[] r\nint32 r_k\n",
    "p/msg/A.msg": "B b\n",
    "p/msg/AB.msg": "int32 x\n",
    "p/msg/B.msg": "int32 x\n",
    "p/msg/R.msg": "A a\nAB a_b\nint32 a_b_x\nstring s\nint64 s_start\nint64 s_count\nint32 t_k\nT[] t\n",
    "p/msg/T.msg": "int32 k\nfloat64 l\n",
}
LIST = {
    "a": {"b": {"x": 1}},
    "a_b": {"x": 2},
    "a_b_x": 3,
    "s": "yz",
    "s_start": 4,
    "s_count": 5,
    "t_k": 6,
    "t": [{"k": 7, "l": 0.5}, {"k": 8, "l": 1.5}],
}
WHOLE = {**{name: value for name, value in LIST.items() if name not in ("t", "t_k")}, "x": 9, "x_": 10, "q": [1.0, 2.0, 3.0], "q_0": 4.0}
IN_ROS = ("p/O", {"encoding": "ros1", "framework": "ros1", "schema": ROS}, {**WHOLE, "r": [LIST, {**LIST, "t": []}], "r_k": 11})

PROTO = """syntax = "proto3"; package p;
message X { int32 x = 1; string s = 2; repeated double d = 3; }
message Y { X b = 1; }
message R { Y a = 1; X a_b = 2; string s = 3; int64 s_start = 4; int64 s_count = 5; int32 s_text = 6; bytes c = 7; int32 c_bytes = 8; }
message O { Y a = 1; X a_b = 2; string s = 3; int64 s_start = 4; int64 s_count = 5; int32 s_text = 6; bytes c = 7; int32 c_bytes = 8;
            repeated R r = 9; }
"""
X = [{"x": number, "s": f"s{number}", "d": [0.5 * number] * number} for number in (1, 2)]
ROW = {"a": {"b": X[0]}, "a_b": X[1], "s": "yz", "s_start": 4, "s_count": 5, "s_text": 6, "c": b"\1\2\3", "c_bytes": 7}
IN_PROTOBUF = ("p.O", {"encoding": "protobuf", "schema": {"p.proto": PROTO}}, {**ROW, "r": [ROW, ROW]})

PACKAGES = {
    "q.proto": 'syntax = "proto3"; import "a.proto"; import "b.proto"; message Pose { int32 v = 1; } '
    "message O { Pose own = 1; a.Pose one = 2; a.b.Pose two = 3; a_b.Pose three = 4; }",
    "a.proto": 'syntax = "proto3"; package a; import public "ab.proto"; message Pose { string w = 1; }',
    "ab.proto": 'syntax = "proto3"; package a.b; message Pose { repeated string x = 1; }',
    "b.proto": 'syntax = "proto3"; package a_b; message Pose { repeated int32 y = 1; }',
}
POSES = {"own": {"v": 1}, "one": {"w": "x"}, "two": {"x": ["a", "b"]}, "three": {"y": [1, 2]}}
OF_PACKAGES = ("O", {"encoding": "protobuf", "imports": ["q.proto"], "schema": PACKAGES}, POSES)

CASES = {"ros1": IN_ROS, "protobuf": IN_PROTOBUF, "packages": OF_PACKAGES}


def messages(type_: str, options: dict[str, Any], value: dict[str, Any]) -> list[bytes]:
    encode = rj.Encoder.of(type_, **options)
    return driver.harmed([bytes(encode(encode.holder_type.from_dict(value)))], 40, type_)


@pytest.mark.parametrize("numpy", [False, True])
@pytest.mark.parametrize("name", CASES)
def test_in_python(name, numpy):
    type_, options, value = CASES[name]
    unit = module(type_request("decode", type_, options), BOTH, Wishes(numpy=numpy))
    programs = rj.Decoder.of(type_, **options), rj.Encoder.of(type_, **options)
    answers_as_the_library(unit, programs, messages(type_, options, value))


@cpp.needs_cpp
@pytest.mark.parametrize("name", CASES)
def test_in_cpp(name, tmp_path):
    type_, options, value = CASES[name]
    unit = cpp.write(tmp_path, generated(type_request("decode", type_, options), "cpp", BOTH, "unit"))
    programs, some = (rj.Decoder.of(type_, **options), rj.Encoder.of(type_, **options)), messages(type_, options, value)
    assert driver.answers(cpp.program(tmp_path, unit, options=cpp.PLAIN), some) == [driver.expected(*programs, each) for each in some]


def test_types_of_several_packages_are_classes_of_their_own():
    type_, options, value = OF_PACKAGES
    unit = module(type_request("decode", type_, options), BOTH, Wishes())
    encode = rj.Encoder.of(type_, **options)
    found = unit.decode(bytes(encode(encode.holder_type.from_dict(value))))
    assert len({type(each) for each in (found.own, found.one, found.two, found.three)}) == 4
