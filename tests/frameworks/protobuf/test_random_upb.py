"""Random schemas, and messages of them in all the ways in which fields may be written: upb reads and refuses what we read and refuse.

Left out is what docs/frameworks.md names as different: unknown fields within entries of maps, and strings of proto2 that are no text.
"""

from __future__ import annotations

import random

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import DecodeError
from grpc_tools import protoc

import rosetta_jit as rj
from tests.frameworks.protobuf.random_schemas import Writer, schema

SCHEMAS, MESSAGES, CAMPAIGN = 2, 150, 400


def peer(text: str, folder):
    (folder / "a.proto").write_text(text)
    assert protoc.main(["protoc", f"-I{folder}", f"--descriptor_set_out={folder / 'set'}", "a.proto"]) == 0, text
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString((folder / "set").read_bytes()).file:
        pool.AddSerializedFile(file.SerializeToString())
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("t.A"))


def read_by_us(decode, message: bytes):
    """A holder, or None and the kind of the error."""
    try:
        return decode(message), ""
    except rj.DecodeError as error:
        return None, error.kind


def compare(seed: int, folder, backend: str = "llvm") -> int:
    """How many of the messages of a random schema both have read."""
    random_ = random.Random(f"upb {seed}")
    text, fields = schema(random_)
    options = {"schema": {"a.proto": text}, "imports": ["a.proto"], "encoding": "protobuf", "backend": backend}
    decode, encode, cls = rj.Decoder.of("t.A", **options), rj.Encoder.of("t.A", **options), peer(text, folder)
    writer, read = Writer(fields, random_), 0
    for _ in range(MESSAGES):
        message = writer.message("A")
        try:
            theirs = cls.FromString(message)
        except DecodeError:
            theirs = None
        ours, kind = read_by_us(decode, message)
        if ours is None:
            assert theirs is None or (kind == "text" and "proto2" in text), (text, message.hex(), kind)
            continue
        assert theirs is not None, (text, message.hex())
        back = cls.FromString(encode(ours))
        back.DiscardUnknownFields()
        theirs.DiscardUnknownFields()
        same = [each.SerializeToString(deterministic=True) for each in (back, theirs)]
        assert same[0] == same[1], (text, message.hex(), ours.to_dict(), str(theirs))
        read += 1
    return read


@pytest.mark.parametrize("seed", range(SCHEMAS))
def test_random_schemas(seed, tmp_path):
    assert compare(seed, tmp_path) > MESSAGES // 10


@pytest.mark.campaign
def test_many_random_schemas(tmp_path):
    assert sum(compare(seed, tmp_path) for seed in range(1_000, 1_000 + CAMPAIGN)) > CAMPAIGN * MESSAGES // 10
