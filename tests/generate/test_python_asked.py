"""Sequences of protobuf that an object may lack, in generated Python: an encoder takes them out of it where they have elements."""

from __future__ import annotations

import random
from array import array

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module, protobuf, source_of

FEW = "message M { string name = 1; repeated string tags = 2; map<int32, int32> counts = 3; repeated double numbers = 4; }"
LINES = """
        if target.name != "":
            name_0 = target.name.encode()
            read_1 = len(name_0)
            parts += b'\\n', _varint(read_1), name_0
        if len(target.tags):
            tags_1 = target.tags
            for element_i in tags_1:
                tags_9 = element_i.encode()
                count_3 = len(tags_9)
                parts += b'\\x12', _varint(count_3), tags_9
        if len(target.counts):
            counts_2 = target.counts
            for key_i_2, value_i_2 in counts_2.items():
"""
ALL = """
    message M {
        string text = 1; bytes raw = 2; repeated int32 numbers = 3; repeated sint64 loose = 4 [packed = false]; repeated string texts = 5;
        repeated bytes blobs = 6; repeated M2 messages = 7; map<string, int32> counts = 8; map<int32, M2> named = 9; M2 one = 10;
        oneof which { M2 case = 11; string word = 12; } optional string maybe = 13; repeated bool flags = 14; repeated float floats = 15;
    }
    message M2 { string text = 1; repeated string texts = 2; map<int32, string> names = 3; repeated fixed32 numbers = 4; bytes raw = 5; }
"""
INNER = {"text": "ä", "texts": ["", "x"], "names": {0: "", 2: "b"}, "numbers": [1], "raw": b"r"}
VALUES = {
    "text": "t",
    "raw": b"\0",
    "numbers": [0, -1],
    "loose": [1, -2],
    "texts": [""],
    "blobs": [b"", b"x"],
    "messages": [{}, INNER],
    "counts": {"": 0, "a": 1},
    "named": {0: {}, 1: INNER},
    "one": INNER,
    "case": {"texts": ["a"]},
    "maybe": "",
    "flags": [False],
    "floats": [0.0],
}
MAPPED = ("messages", "counts", "named", "one")
"""What has maps."""
SEQUENCES = ("text", "raw", "numbers", "loose", "texts", "blobs", "messages", "counts", "named", "flags", "floats")


def test_what_is_empty_stays_in_the_object():
    text = source_of(type_request("encode", "t.M", protobuf(FEW)), ("encode",))
    assert LINES in text


@pytest.mark.parametrize("wishes", [NO_WISHES, Wishes(numpy=True)])
def test_each_alone_and_all(wishes):
    given = protobuf(ALL)
    unit = module(type_request("decode", "t.M", given), BOTH, wishes)
    programs = rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given)
    chance, some = random.Random("asked"), [{}, VALUES, *({name: value} for name, value in VALUES.items())]
    some += [dict(chance.sample([*VALUES.items()], 5)) for _ in range(10)]
    messages = [bytes(programs[1](programs[1].holder_type.from_dict(each))) for each in some]
    without_maps = [message for each, message in zip(some, messages, strict=True) if not any(name in MAPPED for name in each)]
    answers_as_the_library(unit, programs, [*messages, *harmed(without_maps, 40, "asked")])  # of entries of one key a dict has one


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("wrong", [None, 0, False, 0.0, 7])
def test_what_is_no_sequence_is_refused(inside, wrong):
    """Also what is not true: it is not taken for an empty one."""
    unit = module(type_request("decode", "t.M", protobuf(ALL)), BOTH, NO_WISHES)
    for name in ("text", "texts", "names", "numbers", "raw") if inside else SEQUENCES:
        target = unit.M(messages=[unit.M2(**{name: wrong})]) if inside else unit.M(**{name: wrong})
        with pytest.raises(unit.EncodeError) as caught:
            unit.encode(target)
        assert (caught.value.kind, caught.value.path) == ("range", "")


def test_other_sequences_are_taken_for_lists():
    unit = module(type_request("decode", "t.M", protobuf(ALL)), BOTH, NO_WISHES)
    for empty in ((), {}, array("d"), np.zeros(0)):
        assert unit.encode(unit.M(floats=empty, numbers=empty)) == b""
    for floats in ((0.5, 0.0), array("d", [0.5, 0.0]), np.array([0.5, 0.0])):
        assert unit.encode(unit.M(floats=floats)) == unit.encode(unit.M(floats=[0.5, 0.0]))
