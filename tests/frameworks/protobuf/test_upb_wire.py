"""What upb, protobuf's own reader, accepts of unusual tags, lengths and values is what we accept, and both write the same again."""

from __future__ import annotations

import random

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import DecodeError
from grpc_tools import protoc

import rosetta_jit as rj

TEXT = """syntax = "proto2"; package wire;
message A {
  optional int32 v = 1; map<int32, int32> m = 2; optional bytes s = 3; repeated uint64 p = 4 [packed = true]; optional A a = 5;
  optional fixed32 f = 16; repeated string t = 2047; optional group G = 17 { optional int32 v = 1; } extensions 5000 to 6000;
  map<int32, E> e = 6; map<string, E> k = 7; map<int32, A> r = 8;
}
enum E { X = 0; Y = 1; Z = -5; W = 300; }"""
ROUNDS = 3_000


@pytest.fixture(scope="module")
def upb(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wire")
    (folder / "a.proto").write_text(TEXT)
    assert protoc.main(["protoc", f"-I{folder}", f"--descriptor_set_out={folder / 'set'}", "a.proto"]) == 0
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString((folder / "set").read_bytes()).file:
        pool.AddSerializedFile(file.SerializeToString())
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("wire.A"))


@pytest.fixture(scope="module", params=["llvm", "interpreter"])
def programs(request):
    options = {"schema": {"a.proto": TEXT}, "encoding": "protobuf", "backend": request.param}
    return rj.Decoder.of("wire.A", **options), rj.Encoder.of("wire.A", **options)


def written(programs, message: bytes) -> bytes | None:
    """What we make of a message; None where it is refused."""
    decode, encode = programs
    try:
        return encode(decode(message))
    except rj.DecodeError:
        return None


def theirs(upb, message: bytes) -> bytes | None:
    try:
        return upb.FromString(message).SerializeToString(deterministic=True)
    except DecodeError:
        return None


def varint(value: int, length: int = 0) -> bytes:
    """A varint of at least so many bytes, which are more than it needs."""
    parts: list[int] = []
    while value >= 128 or len(parts) < length - 1:
        parts.append(value & 127 | 128)
        value >>= 7
    return bytes([*parts, value])


CASES = {
    "a tag of 10 bytes, bits beyond 64": "8880808080808080802005",
    "a tag of 10 bytes": "8880808080808080800005",
    "a tag of 6 bytes": "88808080800005",
    "a tag of 5 bytes": "888080800005",
    "a tag of 3 bytes": "88800005",
    "a tag with bit 35 set": "88808080800105",
    "a tag with bits 32 to 34": "888080801005",
    "a tag with bit 31": "8080808008" + "05",
    "the number 0": "0005",
    "wire type 6": "0e05",
    "a value of 10 bytes, bits beyond 64": "0885808080808080808020",
    "a value of 11 bytes": "088580808080808080808000",
    "a length of 5 bytes": "1a818080800041",
    "a length of 6 bytes": "1a81808080800041",
    "a length of 2 GiB": "1a8080808008",
    "a length of 4 GiB": "1a8080808010",
    "an unknown field, a length of 6 bytes": "ba3e81808080800041",
    "an unknown field, a tag of 6 bytes": "b8be8080800001",
    "an unknown field, a tag of 5 bytes": "b8be80800001",
    "an unknown group, a tag of 6 bytes within": "bb3e" + "888080808000" + "01" + "bc3e",
    "an unknown group, a tag of 5 bytes within": "bb3e" + "8880808000" + "01" + "bc3e",
    "an unknown group, its end in 6 bytes": "bb3e" + "bcbe80808000",
    "an unknown value of 11 bytes": "b83e" + "80" * 10 + "00",
    "a packed array, a length of 6 bytes": "22818080808000" + "05",
    "a packed array, a value of 10 bytes": "220a" + "85808080808080808020",
    "a message, a length of 6 bytes": "2a828080808000" + "0805",
}


@pytest.mark.parametrize("name", CASES)
def test_unusual_numbers(name, programs, upb):
    message = bytes.fromhex(CASES[name])
    ours, peers = written(programs, message), theirs(upb, message)
    assert (ours is None) == (peers is None), (ours, peers)


def test_kinds(programs):
    decode, _ = programs
    for message, kind in (
        (CASES["a tag of 6 bytes"], "tag"),
        (CASES["a length of 6 bytes"], "length"),
        (CASES["a length of 2 GiB"], "truncated"),
    ):
        with pytest.raises(rj.DecodeError) as error:
            decode(bytes.fromhex(message))
        assert error.value.kind == kind


ENTRIES = {
    "a value that is none": "3204" + "0807" + "1009",
    "one that is negative": "320d" + "0807" + "10ffffffffffffffffff01",
    "a known one behind it": "3206" + "0807" + "1009" + "1001",
    "a known one before it": "3206" + "0807" + "1001" + "1009",
    "no key": "3202" + "1009",
    "the key behind it": "3204" + "1009" + "0807",
    "a key that was there": "3204" + "0807" + "1001" + "3204" + "0807" + "1009",
    "between others": "3204" + "0801" + "1001" + "3204" + "0802" + "1002" + "3205" + "0803" + "10ac02",
    "a text for a key": "3a05" + "0a0161" + "1009" + "3a05" + "0a0162" + "1001",
    "a length of 5 bytes": "32" + "8480808000" + "0807" + "1009",
    "within a message of a map": "420a" + "0801" + "1206" + "3204" + "0807" + "1009",
    "within a message": "2a06" + "3204" + "0807" + "1009",
    "all are known": "3204" + "0807" + "1001" + "3a06" + "0a0161" + "10ac02",
}
"""Entries of maps to a closed enum; ``e`` is field 6, ``k`` 7."""


@pytest.mark.parametrize("name", ENTRIES)
def test_an_entry_whose_value_a_closed_enum_lacks_is_an_unknown_field(name, programs, upb):
    message, (decode, encode) = bytes.fromhex(ENTRIES[name]), programs
    peers, holder = upb.FromString(message), decode(message)
    assert (dict(holder.e), dict(holder.k)) == (dict(peers.e), dict(peers.k))
    again = upb.FromString(encode(holder))
    assert again == peers
    for each in (again, peers):
        each.DiscardUnknownFields()
    assert again == peers


def field(random_: random.Random, depth: int = 0) -> bytes:
    """A field in one of the many ways in which it can be written."""

    def long(most: int) -> int:
        return random_.choice([0, 0, 0, 0, random_.randint(1, most)])

    number, wire = random_.choice(
        [(1, 0), (3, 2), (4, 2), (4, 0), (5, 2), (16, 5), (2047, 2), (999, 0), (999, 1), (999, 2), (17, 3), (999, 3)]
    )
    tag = varint(number << 3 | wire, long(6))
    match wire:
        case 0:
            return tag + varint(random_.getrandbits(random_.choice([7, 31, 63])), long(11))
        case 1:
            return tag + random_.randbytes(8)
        case 5:
            return tag + random_.randbytes(4)
        case 3:
            inside = b"".join(field(random_, depth + 1) for _ in range(random_.randrange(3))) if depth < 3 else b""
            return tag + inside + varint(number << 3 | 4, long(6))
    if number == 5:
        inside = b"".join(field(random_, depth + 1) for _ in range(random_.randrange(3))) if depth < 3 else b""
    elif number == 4:
        inside = b"".join(varint(random_.getrandbits(20), long(11)) for _ in range(random_.randrange(3)))
    else:
        inside = b"x" * random_.randrange(5)
    return tag + varint(len(inside), long(6)) + inside


def test_random_messages(programs, upb, request):
    random_ = random.Random(7)
    rounds = ROUNDS // 30 if request.node.callspec.params["programs"] == "interpreter" else ROUNDS
    refused = 0
    for _ in range(rounds):
        message = b"".join(field(random_) for _ in range(random_.randrange(1, 4)))
        ours, peers = written(programs, message), theirs(upb, message)
        assert (ours is None) == (peers is None), (message.hex(), ours, peers)
        refused += ours is None
        if ours is not None:
            assert upb.FromString(ours) == upb.FromString(message), message.hex()
    assert 0 < refused < rounds
