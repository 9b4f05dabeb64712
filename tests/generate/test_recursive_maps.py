"""Maps of the type that contains them, as google.protobuf.Struct has them: generated C++ fills and reads the values of their entries."""

from __future__ import annotations

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from tests.generate import cpp, native
from tests.generate.driver import answers, expected

TEXT = """syntax = "proto3"; package t;
message Value { oneof kind { double number = 1; string text = 2; List list = 3; Struct struct = 4; } }
message List { repeated Value values = 1; }
message Struct { map<string, Value> fields = 1; }
"""
OPTIONS = {"encoding": "protobuf", "schema": {"t.proto": TEXT}}
VALUES = [
    {"struct": {"fields": {"a": {"number": 2.5}}}},
    {
        "struct": {
            "fields": {
                "a": {
                    "struct": {
                        "fields": {
                            "b": {"text": "x"},
                        }
                    }
                }
            }
        }
    },
    {"struct": {"fields": {"a": {}}}},
    {"list": {"values": [{"struct": {"fields": {}}}, {"text": "y"}]}},
]


def messages():
    encode = rj.Encoder.of("t.Value", **OPTIONS)
    return [bytes(encode(encode.holder_type.from_dict(each))) for each in VALUES]


def same_key_twice():
    """The later entry has no value, so that a default one takes the place of the earlier."""
    decode, encode = rj.Decoder.of("t.Value", **OPTIONS), rj.Encoder.of("t.Value", **OPTIONS)
    earlier, later = bytes.fromhex("0a0e0a0161120909000000000000f03f"), bytes.fromhex("0a030a0161")
    twice = b"\x22" + bytes([len(earlier + later)]) + earlier + later
    decode(twice)  # the library takes it, too
    return twice, f"ok {bytes(encode(encode.holder_type.from_dict(VALUES[2]))).hex()}"


def compare(program):
    decode, encode = rj.Decoder.of("t.Value", **OPTIONS), rj.Encoder.of("t.Value", **OPTIONS)
    twice, once = same_key_twice()
    given = [*messages(), messages()[1][:-1], twice]
    found = answers(program, given)
    assert found == [*(expected(decode, encode, each) for each in given[:-1]), once]


@cpp.needs_cpp
def test_classes_of_our_own(tmp_path):
    name = cpp.write(tmp_path, generated(type_request("decode", "t.Value", OPTIONS), "cpp", ("decode", "encode"), "unit"))
    compare(cpp.program(tmp_path, name, options=(*cpp.PLAIN, "-Wshadow")))


@cpp.needs_cpp
def test_classes_of_protoc(tmp_path):
    native.protoc(tmp_path, "t", TEXT)
    wishes = Wishes(holder="protobuf", include="t.pb.h")
    name = cpp.write(tmp_path, generated(type_request("decode", "t.Value", OPTIONS), "cpp", ("decode", "encode"), "unit", wishes))
    compare(native.program_of_protoc(tmp_path, name, "t", cpp.PLAIN))
