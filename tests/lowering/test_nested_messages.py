"""Messages within messages of protobuf: what the loops around them have shown is not checked again."""

from __future__ import annotations

import re

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.kernel.passes import order
from rosetta_jit.kernel.proof.verify import verify
from rosetta_jit.pipeline.build import Build
from tests.frameworks.protobuf.proto_files import varint

DEPTH = 12
LEVELS = "\n".join(f"message Level{level} {{ repeated Level{level - 1} inner = 1; optional int64 n = 300; }}" for level in range(1, DEPTH))
PROTO = f'syntax = "proto2"; package deep;\nmessage Level0 {{ repeated double values = 1 [packed = true]; }}\n{LEVELS}\n'
OPTIONS = {"encoding": "protobuf", "schema": {"deep.proto": PROTO}}
TWO = "deep.Level2"


def decoder(name=TWO, **options):
    return rj.Decoder.of(name, **OPTIONS, **options)


def length(message, number=1):
    return varint(number << 3 | 2) + varint(len(message)) + message


def body():
    """What a kernel says of a message of two levels, without its routines and sites."""
    return decoder().stage("kernel").partition("body 0:")[2].partition("sites:")[0]


def test_bytes_that_a_length_has_shown_are_not_asked_for_again():
    assert len(re.findall(r"let length", body())) > 2
    assert "require [next" not in re.sub(r"require \[next\w*\] 8 ", "", body())


def test_a_field_is_not_asked_whether_it_gets_on():
    assert not re.search(r"expect \(+(at|next)\w* >", body())
    assert "size_of_field >= 0" not in body()


def test_a_message_that_goes_on_has_a_tag():
    assert "require [at" not in body()


@pytest.mark.parametrize("direction", ["decode", "encode"])
def test_what_is_left_of_deep_messages_is_proven_by_itself(direction):
    """The checks that were left out are not what the proof of the others rests on."""
    for kernel in Build(type_request(direction, f"deep.Level{DEPTH - 1}", OPTIONS)).kernels:
        verify(kernel)
        assert order.run(kernel) is not None


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_a_message_that_ends_within_a_number(backend):
    decode = decoder("deep.Level1", backend=backend)
    tag = varint(300 << 3)
    short, long = tag + varint(300), tag + varint(1 << 40)
    for whole, end in ((short, 1), (short, 2), (short, 3), (long, 6)):
        with pytest.raises(rj.DecodeError) as caught:
            decode(whole[:end])
        assert (caught.value.kind, caught.value.offset) == ("truncated", end)
        assert decode(whole).n in (300, 1 << 40)


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_lengths_of_two_and_three_bytes(backend):
    decode = decoder("deep.Level1", backend=backend)
    for count in (1, 16, 40, 3000):
        values = length(bytes(8 * count))
        assert len(decode(length(values)).inner[0].values) == count
        with pytest.raises(rj.DecodeError) as caught:
            decode(varint(1 << 3 | 2) + varint(len(values) + 1) + values)
        assert caught.value.kind == "truncated"
        with pytest.raises(rj.DecodeError):
            decode(length(length(bytes(8 * count + 1))))


def test_a_large_type_becomes_fewer_instructions():
    """6,900 before: failures that report the same share a block, and sites that no sum gives are looked up."""
    text = rj.Decoder.of("rst.vision.HeadObjects", encoding="protobuf").stage("llvm")
    kernel = text.partition("@kernel(")[2].partition("\n}")[0]
    assert len(re.findall(r"^  \S", kernel, re.MULTILINE)) < 6_300
