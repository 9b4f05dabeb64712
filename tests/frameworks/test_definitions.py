"""The definitions of types that logs carry: who reads one has the same type again, and protobuf's own package takes its descriptors."""

from __future__ import annotations

import json

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool

import rosetta_jit as rj

COMMON = """
package p.q;
message Outer {
  enum Mode { A = 0; B = 5; }
  message Inner { map<string, Other> others = 1; repeated Mode modes = 2; }
  oneof which { Inner inner = 3; string text = 4; }
  repeated double values = 5;
  bytes blob = 6 [json_name = "chunk"];
  int32 snake_case = 7;
}
message Other { repeated Outer.Inner inner = 1; }
"""
PROTO2 = COMMON.replace("  bytes", "  optional bytes").replace("  int32", "  required int32") + (
    'message Old { optional string s = 1 [default = "a\\"b"]; optional bytes b = 2 [default = "\\000\\\\"]; optional Outer o = 3;\n'
    "  optional float f = 4 [default = inf]; optional Outer.Mode m = 5 [default = B]; repeated group G = 6 { optional bool x = 1; } }\n"
)
EDITION = COMMON + (
    "message New { int32 a = 1 [features.field_presence = IMPLICIT]; int32 b = 2 [features.field_presence = LEGACY_REQUIRED];\n"
    "  Outer c = 3 [features.message_encoding = DELIMITED]; repeated int32 d = 4 [features.repeated_field_encoding = EXPANDED]; }\n"
)
TYPES = {
    "proto2": ('syntax = "proto2";' + PROTO2, ("p.q.Outer", "p.q.Old")),
    "proto3": ('syntax = "proto3";' + COMMON + "message Maybe { optional int32 x = 1; Outer o = 2; }\n", ("p.q.Outer", "p.q.Maybe")),
    "editions": ('edition = "2023";' + EDITION, ("p.q.Outer", "p.q.New")),
}


def pool_of(data):
    pool = descriptor_pool.DescriptorPool()
    for each in descriptor_pb2.FileDescriptorSet.FromString(data).file:
        pool.Add(each)
    return pool


def without_units(plain):
    """Units are said by an option of ours, which is not carried."""
    for declared in plain["declared"].values():
        for each in declared.get("fields", ()):
            each.pop("unit", None)
            each.pop("part_units", None)
    return plain


def text_of(program):
    return without_units(json.loads(program.holder_type.family_.text))


@pytest.mark.parametrize("syntax", TYPES)
def test_protobuf_of_each_syntax(syntax):
    text, names = TYPES[syntax]
    for name in names:
        made = rj.Decoder.of(name, imports=["a.proto"], schema={"a.proto": text}, backend="interpreter")
        assert made.definition.language == "protobuf"
        pool_of(made.definition.data).FindMessageTypeByName(name)
        again = rj.Decoder.of(name, encoding="protobuf", schema=made.definition.data, backend="interpreter")
        assert text_of(again) == text_of(made)


def test_protobuf_of_several_files():
    made = rj.Decoder("ros1/wrench.mapping", backend="interpreter")
    name = made.holder_type.family_.struct.name
    assert len(descriptor_pb2.FileDescriptorSet.FromString(made.definition.data).file) > 1
    pool_of(made.definition.data).FindMessageTypeByName(name)
    again = rj.Decoder.of(name, encoding="protobuf", schema=made.definition.data, backend="interpreter")
    assert text_of(again) == text_of(made)


@pytest.mark.parametrize(
    ("type_", "encoding", "language"),
    [
        ("sensor_msgs/Imu", "ros1", "ros1msg"),
        ("sensor_msgs/msg/JointState", "cdr", "ros2msg"),
        ("exlcm.example_t", "lcm", "lcm"),
        ("yarp.sig.ImageOfPixelRgb", "yarp3", "bottle-schema"),
    ],
)
def test_texts(type_, encoding, language):
    made = rj.Decoder.of(type_, encoding=encoding, backend="interpreter")
    assert made.definition.language == language
    again = rj.Decoder.of(type_, encoding=encoding, schema=made.definition.data.decode(), backend="interpreter")
    assert again.holder_type.family_.text == made.holder_type.family_.text


def test_types_that_logs_carry_no_definition_of():
    assert (
        rj.Decoder.of("RTC.TimedDoubleSeq", encoding="cdr-giop", imports=["openrtm/BasicDataType.idl"], backend="interpreter").definition
        is None
    )
