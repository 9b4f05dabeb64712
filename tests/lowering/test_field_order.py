"""Fields of protobuf messages in the order of their numbers, and in any other: what is guessed must not change what is read."""

from __future__ import annotations

import random
import re
import struct

import pytest

import rosetta_jit as rj
from rosetta_jit.lowering.codec.field_order import MOST_GUESSED
from tests.frameworks.protobuf.proto_files import varint

NUMBERS = [*range(1, 25), *range(120, 134), 2047, 2048]
"""Tags of one byte, of two, and of three."""

FIELDS = "".join(f" required int64 field{number} = {number};" for number in NUMBERS)
PROTO = f"""syntax = "proto2"; package order;
enum Colour {{ RED = 0; GREEN = 1; }}
message Fields {{ {FIELDS} }}
message Mixed {{
  optional int64 a = 1; required int64 b = 2; repeated int32 list = 3000; optional Colour colour = 3001; optional bytes end = 3002;
}}
"""

pytestmark = pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])


def field(number, value):
    return varint(number << 3) + varint(value)


def decoder(backend, name="Fields"):
    return rj.Decoder.of(f"order.{name}", encoding="protobuf", schema={"order.proto": PROTO}, backend=backend)


def orders():
    chance = random.Random(7)
    pairs = [(number, chance.choice([3, 300, 1 << 40])) for number in NUMBERS]
    yield pairs
    yield pairs[::-1]
    yield [each for each in pairs for _ in range(2)]
    yield [(number, value + again) for again in range(2) for number, value in pairs]
    yield chance.sample(pairs, len(pairs))


def test_any_order_is_read(backend):
    decode = decoder(backend)
    for pairs in orders():
        decoded = decode(b"".join(field(*pair) for pair in pairs))
        assert [getattr(decoded, f"field{number}") for number in NUMBERS] == [dict(pairs)[number] for number in NUMBERS]


def test_arrays_unknown_fields_and_enums_between_known_ones(backend):
    decode = decoder(backend, "Mixed")
    unknown = varint(77 << 3 | 1) + struct.pack("<d", 1.5)
    message = field(1, 5) + unknown + field(2, 6) + b"".join(field(3000, each) for each in range(300)) + field(3001, 7) + field(3001, 1)
    decoded = decode(message + varint(3002 << 3 | 2) + b"\x02ab")
    assert (decoded.a, decoded.b, decoded.colour, bytes(decoded.end)) == (5, 6, 1, b"ab")
    assert list(decoded.list) == list(range(300))


def test_every_cut_is_refused(backend):
    decode = decoder(backend)
    parts = [field(number, 1 << 20) for number in NUMBERS]
    ends = {sum(map(len, parts[:count])) for count in range(len(parts))}
    message = b"".join(parts)
    assert decode(message).field2048 == 1 << 20
    for size in range(len(message)):
        with pytest.raises(rj.DecodeError) as error:
            decode(message[:size])
        assert (error.value.kind == "missing") == (size in ends)


def test_a_tag_written_too_long_is_read(backend):
    assert decoder(backend, "Mixed")(field(1, 5) + b"\x90\x00\x07" + field(3000, 8)).b == 7


def test_a_guess_at_the_end_of_an_inner_message_stays_inside(backend):
    schema = "syntax = 'proto2'; package order; message In { required int32 a = 1; required int32 b = 2; }"
    schema += " message Out { required In inner = 1; required int32 b = 2; }"
    decode = rj.Decoder.of("order.Out", encoding="protobuf", schema={"order.proto": schema}, backend=backend)
    decoded = decode(b"\x0a\x04\x08\x05\x10\x06\x10\x07")
    assert (decoded.inner.a, decoded.inner.b, decoded.b) == (5, 6, 7)
    with pytest.raises(rj.DecodeError) as error:
        decode(b"\x0a\x02\x08\x05\x10\x07")
    assert (error.value.kind, error.value.path) == ("missing", ".inner.b")
    with pytest.raises(rj.DecodeError):
        decode(b"\x0a\x03\x08\x05\x10\x07")


def test_what_is_guessed_is_jumped_to(backend):
    if backend != "llvm":
        pytest.skip("the others go through the loop")
    code = decoder(backend).stage("llvm")
    # Behind a field: its bytes are compared with the next one's tag, but not in the last of each run of 16, nor before tags of three bytes.
    assert code.count("load i16") >= len(NUMBERS) - len(NUMBERS) // 16 - 2


def test_what_one_message_is_read_with_is_not_kept_for_the_next_one(backend):
    if backend != "llvm":
        pytest.skip("the others go through the loop")
    schema = "syntax = 'proto2'; package order; message In { required int32 a = 1; required int32 b = 2; }"
    schema += f" message Out {{ {' '.join(f'required In inner{number} = {number};' for number in range(1, 5))} }}"
    code = rj.Decoder.of("order.Out", encoding="protobuf", schema={"order.proto": schema}, backend=backend).stage("llvm")
    assert not re.search(r"= phi [^\n]*\bundef\b", code)


def test_what_may_be_absent_is_not_guessed(backend):
    if backend != "llvm":
        pytest.skip("the others go through the loop")
    schema = {"order.proto": f'syntax = "proto3"; package order; message Fields {{ {FIELDS.replace("required ", "")} }}'}
    assert "load i16" not in rj.Decoder.of("order.Fields", encoding="protobuf", schema=schema, backend=backend).stage("llvm")


@pytest.mark.parametrize("count", [MOST_GUESSED, MOST_GUESSED + 1])
def test_few_fields_are_guessed(backend, count):
    if backend != "llvm":
        pytest.skip("the others go through the loop")
    fields = "".join(f" required int64 f{number} = {number};" for number in range(1, count + 1))
    schema = {"order.proto": f'syntax = "proto2"; package order; message Fields {{ {fields} }}'}
    decode = rj.Decoder.of("order.Fields", encoding="protobuf", schema=schema, backend=backend)
    assert ("load i16" in decode.stage("llvm")) is (count == MOST_GUESSED)
    decoded = decode(b"".join(field(number, number % 300) for number in range(1, count + 1)))
    assert [getattr(decoded, f"f{number}") for number in range(1, count + 1)] == [number % 300 for number in range(1, count + 1)]
