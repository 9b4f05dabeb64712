"""Protobuf's own files: those that we ship say what its package says, and mappings import them as any others."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.protobuf.idl import parse
from rosetta_jit.model.types import Struct
from rosetta_jit.source import Source, shipped_folders

FOLDER = "google/protobuf"
FILES = sorted(path.name for path in (shipped_folders()[0] / FOLDER).glob("*.proto"))

STAMP = """import "google/protobuf/timestamp.proto"
import "std_msgs/Header"
data-holder: std_msgs/Header
wire-schema: google.protobuf.Timestamp
rules:
  .stamp.secs <-> uint32(.seconds)
  .stamp.nsecs <-> uint32(.nanos)
  default rest
"""


@pytest.mark.parametrize("name", FILES)
def test_shipped_files_declare_what_the_package_does(name):
    def ours(path: str) -> Source | None:
        file = shipped_folders()[0] / path
        return Source(path, file.read_text("utf-8")) if file.exists() else None

    importing = Source("a.proto", f'syntax = "proto3";\nimport "{FOLDER}/{name}";\n')
    found, theirs = parse(importing, ours), parse(importing, lambda _: None)
    assert found.types
    assert found.types == theirs.types


def test_mappings_import_them():
    decode = rj.Decoder("stamp.mapping", schema={"stamp.mapping": STAMP}, encoding="protobuf", backend="interpreter")
    assert decode(b"\x08\x05\x10\x07").stamp.to_dict() == {"secs": 5, "nsecs": 7}
    named = rj.Decoder.of("google.protobuf.Timestamp", imports=[f"{FOLDER}/timestamp.proto"], backend="interpreter")
    assert named(b"\x08\x05\x10\x07").seconds == 5


def test_they_are_found_by_their_names():
    for file in FILES:
        importing = Source("a.proto", f'syntax = "proto3";\nimport "{FOLDER}/{file}";\n')
        for name in (each for each, declared in parse(importing, lambda _: None).types.items() if isinstance(declared, Struct)):
            decode = rj.Decoder.of(name, backend="interpreter")
            assert decode.holder_type is rj.Decoder.of(name, imports=[f"{FOLDER}/{file}"], backend="interpreter").holder_type
    assert rj.Decoder.of("google.protobuf.Timestamp")(b"\x08\x05\x10\x07").seconds == 5
    with pytest.raises(rj.SchemaError, match=r"no file declares a message `google\.protobuf\.Foo`"):
        rj.Decoder.of("google.protobuf.Foo")


def test_types_of_descriptors_alone_need_an_encoding():
    """Nothing but the package's descriptors declares them: no file says in which language."""
    schema = {"a.proto": f'syntax = "proto3";\nimport "{FOLDER}/type.proto";\nmessage A {{ google.protobuf.Option option = 1; }}\n'}
    with pytest.raises(rj.SchemaError, match="nothing says in which language"):
        rj.Decoder.of("google.protobuf.Option", schema=schema, backend="interpreter")
    decode = rj.Decoder.of("google.protobuf.Option", schema=schema, encoding="protobuf", backend="interpreter")
    assert decode(b"\x0a\x01x").name == "x"
