"""What protoc calls the class of a message: package and messages are told from each other by what they are, not by how they are written."""

from __future__ import annotations

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from tests.generate import cpp, driver, native

SCHEMA = """syntax = "proto3";
package Lab.arm.Kin;
message pose {
  double x = 1;
  message inner { int32 a = 1; message Deep { int32 b = 1; } repeated Deep deep = 2; }
  inner one = 2; repeated inner many = 3; map<string, inner> named = 4; oneof of { inner y = 5; string z = 6; }
}
"""
CLASSES = {
    "Lab.arm.Kin.pose": "::Lab::arm::Kin::pose",
    "Lab.arm.Kin.pose.inner": "::Lab::arm::Kin::pose_inner",
    "Lab.arm.Kin.pose.inner.Deep": "::Lab::arm::Kin::pose_inner_Deep",
}
UNITS = {f"of_{type_.rpartition('.')[2].lower()}": type_ for type_ in CLASSES}
MESSAGES = [b"", b"\x09" + bytes(8), b"\x12\x02\x08\x05", b"\x1a\x04\x12\x02\x08\x07", b"\x2a\x02\x08\x01", b"\x08\x07", b"\x0a\xff"]


def test_classes_are_found_whatever_packages_and_messages_are_called(tmp_path):
    options = {"encoding": "protobuf", "schema": {"lab.proto": SCHEMA}}
    texts = {
        type_: generated(type_request("decode", type_, options), "cpp", ("decode", "encode"), unit, Wishes(holder="protobuf"))
        for unit, type_ in UNITS.items()
    }
    for unit, type_ in UNITS.items():
        assert f"using holder = {CLASSES[type_]};" in texts[type_][f"{unit}.hpp"]
    native.protoc(tmp_path, "lab", SCHEMA)
    name = cpp.write_as_one(tmp_path, "units", texts.values())
    program = native.program_of_protoc(tmp_path, name, "lab", cpp.PLAIN, UNITS)
    for unit, type_ in UNITS.items():
        programs = rj.Decoder.of(type_, **options), rj.Encoder.of(type_, **options)
        assert driver.answers(program, MESSAGES, unit=unit) == [driver.expected(*programs, each) for each in MESSAGES]
