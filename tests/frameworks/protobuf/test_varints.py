"""Base-128 integers of all lengths, in messages of few and of many fields: what is read in place, and what a routine reads."""

from __future__ import annotations

import random

import numpy as np
import pytest

import rosetta_jit as rj
from tests.frameworks.protobuf.proto_files import varint

BACKENDS = ["llvm", "python", "interpreter"]
MANY = 70
"""Fields of a message: more than the calls of a routine that stay in place."""


def schema(fields):
    lines = "\n".join(f"  optional uint64 field{number} = {number};" for number in range(1, fields + 1))
    return {"varints.proto": f"syntax = 'proto2';\nmessage Varints {{\n{lines}\n}}\n"}


def programs(fields, backend):
    options = {"encoding": "protobuf", "schema": schema(fields), "backend": backend}
    return rj.Decoder.of("Varints", **options), rj.Encoder.of("Varints", **options)


def values(fields, seed):
    """One of each length, the smallest and the largest, and then some."""
    edges = [each for bits in range(7, 64, 7) for each in (2**bits - 1, 2**bits)]
    edges += [0, 1, 2**64 - 1]
    return [edges[(seed + number) % len(edges)] for number in range(fields)]


def message_of(numbers):
    return b"".join(varint(field << 3) + varint(number) for field, number in enumerate(numbers, 1))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("fields", [2, 20, MANY])
def test_values_of_all_lengths(fields, backend):
    decode, encode = programs(fields, backend)
    for seed in range(23):
        numbers = values(fields, seed)
        holder = decode(message_of(numbers))
        assert [getattr(holder, f"field{number}") for number in range(1, fields + 1)] == numbers
        assert encode(holder) == message_of(numbers)


@pytest.mark.parametrize("backend", BACKENDS)
def test_whatever_follows(backend):
    """Up to eight bytes are looked at together, of which some may be those behind."""
    decode, encode = programs(2, backend)
    for first in values(23, 0):
        for second in (0, 2**7, 2**42 - 1, 2**64 - 1):
            message = message_of([first, second])
            holder = decode(message)
            assert (holder.field1, holder.field2) == (first, second)
            assert encode(holder) == message
        for longer in range(1, 11 - len(varint(first))):
            padded = varint(first)[:-1] + bytes([varint(first)[-1] | 0x80]) + b"\x80" * (longer - 1) + b"\x00"
            for behind in (b"", varint(16) + bytes([7]), varint(16) + varint(2**63)):
                assert decode(b"\x08" + padded + behind).field1 == first


@pytest.mark.parametrize("backend", ["llvm", "python"])
def test_values_of_many_messages(backend):
    decode, encode = programs(20, backend)
    messages = [message_of(values(20, seed)) for seed in range(23)]
    rows = decode.many(b"".join(messages), np.cumsum([0, *map(len, messages)]))
    assert rows.field3.tolist() == [values(20, seed)[2] for seed in range(23)]
    assert bytes(encode.many(rows)[0]) == b"".join(messages)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("kind", ["uint64", "sint32", "bool", "int32"])
def test_arrays_are_measured_and_written(kind, backend):
    """Behind a nested message, whose length takes the array's into account, and in front of another field."""
    lines = (
        f"message Inner {{ repeated {kind} numbers = 3; string name = 4; }}\nmessage Outer {{ Inner inner = 1; repeated {kind} more = 2; }}"
    )
    schema = {"o.proto": f"syntax = 'proto3';\n{lines}\n"}
    encode = rj.Encoder.of("Outer", encoding="protobuf", schema=schema, backend=backend)
    decode = rj.Decoder.of("Outer", encoding="protobuf", schema=schema, backend=backend)
    numbers = {"uint64": values(23, 0), "sint32": [0, -1, 63, -65, 2**31 - 1, -(2**31)], "bool": [True, False], "int32": [-1, 0, 127, 128]}
    for count in range(len(numbers[kind]) + 1):
        holder = encode.new()
        holder.inner.numbers.extend(numbers[kind][:count])
        holder.inner.name = "n"
        holder.more.extend(numbers[kind][count:])
        message = encode(holder)
        assert encode.size(holder) == len(message)
        assert decode(message) == holder


@pytest.mark.parametrize("fields", [2, MANY])
def test_what_ends_too_early_or_never(fields):
    """Kind, field and place of a failure are the interpreter's, in every backend."""
    numbers = [2**64 - 1] * fields
    whole = message_of(numbers)
    rng = random.Random(fields)
    places = sorted({*range(1, 24), *(rng.randrange(1, len(whole)) for _ in range(40))} - {len(whole)})
    broken = [whole[:place] for place in places if place < len(whole)]
    broken += [whole[:-1] + b"\xff\x01", b"\x80" * 11, b"\xf8" + b"\xff" * 20, b"\x08" + b"\xff" * 20, b"\x08" + b"\xff" * 9 + b"\x80" * 20]
    decoders = {backend: programs(fields, backend)[0] for backend in BACKENDS}
    said = {backend: [failure(decode, message) for message in broken] for backend, decode in decoders.items()}
    assert any(each is not None and each[1] for each in said["interpreter"])
    assert all(each == said["interpreter"] for each in said.values())


def failure(decode, message):
    try:
        decode(message)
    except rj.DecodeError as error:
        return error.kind, error.path, error.offset
    return None


def packed_programs():
    schema = {"p.proto": "syntax = 'proto3';\nmessage Packed { repeated uint64 numbers = 1; }\n"}
    return [rj.Decoder.of("Packed", encoding="protobuf", schema=schema, backend=backend) for backend in BACKENDS]


def test_arrays_of_values_of_all_lengths():
    """Two of each length in each order, the last of them at the end of the message and before more; and cut everywhere."""
    decoders = packed_programs()
    for first in values(23, 0):
        for second in values(23, 0):
            body = varint(first) + varint(second)
            message = b"\x0a" + varint(len(body)) + body
            for decode in decoders:
                assert decode(message).numbers.tolist() == [first, second]
                assert decode(message + b"\x0a\x01\x05").numbers.tolist() == [first, second, 5]
    for end in range(len(message)):
        failures = set()
        for decode in decoders:
            with pytest.raises(rj.DecodeError) as caught:
                decode(message[:2][:end] + message[2:end] if end else b"\x0a")
            failures.add((caught.value.kind, caught.value.path, caught.value.offset))
        assert len(failures) == 1


def test_the_last_number_of_an_array_ends_with_it():
    """Where its bytes go on beyond the array, whatever they are, all backends say the same."""
    for body in (b"\x80", b"\x01\x80", b"\xff\xff"):
        message = b"\x0a" + bytes([len(body)]) + body + b"\x01\x01\x01"
        failures = set()
        for decode in packed_programs():
            with pytest.raises(rj.DecodeError, match="beyond the array") as caught:
                decode(message)
            failures.add((caught.value.kind, caught.value.path, caught.value.offset))
        assert len(failures) == 1
