"""Drafted `.proto` files describe the messages that they were drafted from, down to their bytes."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj

PEER = json.loads((Path(__file__).parents[2] / "vectors" / "protobuf" / "peer.json").read_text())
RECORDS = {}
for record in PEER["records"]:
    RECORDS.setdefault(record["type"], []).append(bytes.fromhex(record["hex"]))

POINT = struct.pack("<BdBd", 9, 1.5, 17, -2.0)


def field(number, content):
    return bytes([number << 3 | 2, len(content)]) + content


def drafted(messages, name="lab.Captured"):
    return rj.infer(messages, name=name, encoding="protobuf")


def rules(text):
    return [line.partition(";")[0].strip() for line in text.splitlines() if " = " in line and "syntax" not in line]


@pytest.mark.parametrize("name", [name for name in RECORDS if name != "rj.Groups"])
def test_bytes_of_the_peer_come_back(name):
    schema = {"captured.proto": drafted(RECORDS[name])}
    options = {"schema": schema, "encoding": "protobuf", "backend": "python"}
    decode, encode = rj.Decoder.of("lab.Captured", **options), rj.Encoder.of("lab.Captured", **options)
    for data in RECORDS[name]:
        assert encode(decode(data)) == data


def test_what_values_suggest():
    numbers = b"\x08\x07" + struct.pack("<Bf", 0x15, 0.5)
    packed = field(5, struct.pack("<3d", 1.0, 2.5, -3.0))
    texts = field(6, "héllo".encode()) + field(6, b"x")
    text = drafted([numbers + field(3, POINT) + packed + texts + field(7, b"\xff\0"), b"\x08\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"])
    assert rules(text) == [
        "optional int64 f1 = 1",
        "optional float f2 = 2",
        "optional double f1 = 1",
        "optional double f2 = 2",
        "optional F3 f3 = 3",
        "repeated double f5 = 5 [packed = true]",
        "repeated string f6 = 6",
        "optional bytes f7 = 7",
    ]
    assert "package lab;" in text
    assert "// -1 to 7" in text
    assert "; in 1 of 2" in text


def test_what_is_a_message_in_all_occurrences_alone():
    assert "message F1" in drafted([field(1, POINT), field(1, POINT)])
    assert rules(drafted([field(1, POINT), field(1, b"\xff\0")])) == ["optional bytes f1 = 1"]


@pytest.mark.parametrize(
    ("messages", "words"),
    [
        ([b"\x08\x01", b"\x08"], "truncated: message 2: the message ends within a varint - at byte 1"),
        ([b"\x0a\x05ab"], "truncated: message 1: field 1 has 5 bytes, of which 2 are there"),
        ([b"\0\0"], "tag: message 1: a field has the number 0"),
        ([b"\x0b\x0c"], "tag: message 1: field 1 is a group"),
        ([b"\x0e"], "which there is not"),
        ([b"\x08" + b"\xff" * 10], "varint: message 1: a varint has more than 64 bits"),
        ([b"\x08\x01", b"\x0a\0"], "message 2 has field 1 as length-delimited, where it was varint before"),
        ([], "no message to draft"),
    ],
)
def test_what_cannot_be_described(messages, words):
    with pytest.raises(rj.RosettaError) as error:
        drafted(messages)
    assert words in str(error.value)


def test_names_and_encodings():
    with pytest.raises(rj.SchemaError, match="is no name of a message"):
        drafted([b""], name="a b")
    for encoding in ("ros1", "cdr", "lcm"):
        with pytest.raises(rj.SchemaError, match=f"of messages in `{encoding}`: their bytes do not tell where a field begins"):
            rj.infer([b"abc"], name="x", encoding=encoding)
    with pytest.raises(rj.SchemaError, match="there is no encoding `ros3`"):
        rj.infer([b"abc"], name="x", encoding="ros3")


@settings(max_examples=40, deadline=None)
@given(st.lists(st.binary(max_size=60), min_size=1, max_size=3))
def test_any_bytes(messages):
    try:
        text = drafted(messages)
    except rj.RosettaError:
        return
    rj.Decoder.of("lab.Captured", schema={"captured.proto": text}, encoding="protobuf", backend="interpreter")


def test_nesting_is_bounded():
    message = b"\x08\x01"
    for _ in range(30):
        message = field(1, message)
    assert drafted([message]).count("message F1") == 16


def test_what_never_varied_is_said_once():
    text = rj.infer([b"\x0a\x02ab\x10\x05", b"\x0a\x02cd\x10\x05"], name="seen", encoding="protobuf")
    assert "// 2 bytes" in text
    assert "// 5: an integer or an enum" in text
