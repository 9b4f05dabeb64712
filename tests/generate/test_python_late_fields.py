"""Lists, maps and messages of protobuf that may not come, in generated Python: nothing is made for them before they do."""

from __future__ import annotations

import copy
import dataclasses
import gc
import random

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module, protobuf, source_of

BODY = """
    enum E { ZERO = 0; ONE = 1; }
    message Inner { string text = 1; repeated int32 numbers = 2; optional Inner2 deeper = 3; oneof w { int32 x = 4; Inner2 y = 5; } }
    message Inner2 { double d = 1; bool b = 2; bytes raw = 3; repeated string texts = 4; }
    message M {
        repeated int32 packed = 1; repeated double unpacked = 2 [packed = false]; repeated bool flags = 3; repeated string texts = 4;
        repeated bytes blobs = 5; repeated Inner inners = 6; map<string, int32> counts = 7; map<int32, Inner> named = 8;
        Inner one = 9; Inner other = 10; oneof which { Inner case = 11; string word = 12; } repeated E enums = 13; int32 number = 14;
    }
"""
INNER = {"text": "ä", "numbers": [1, 300], "deeper": {"d": 0.5, "raw": b"r", "texts": ["t", ""]}, "y": {"b": True}}
VALUES = {
    "packed": [1, -1],
    "unpacked": [0.5],
    "flags": [True, False],
    "texts": ["a", "ä"],
    "blobs": [b"x"],
    "inners": [INNER, {}],
    "counts": {"a": 1},
    "named": {1: INNER},
    "one": INNER,
    "other": {},
    "case": INNER,
    "enums": [1],
    "number": 7,
}
UNKNOWN = b"\xf8\x06\x05"


@pytest.mark.parametrize("wishes", [NO_WISHES, Wishes(numpy=True)])
def test_fields_begin_where_they_come(wishes):
    """None, each alone, all of them; in any order, in pieces between others, with fields that the schema does not know; and broken."""
    given = protobuf(BODY)
    request = type_request("decode", "t.M", given)
    assert "if not has_one:" in source_of(request, BOTH, wishes)
    unit, programs = module(request, BOTH, wishes), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    parts = {name: bytes(programs[1](programs[1].holder_type.from_dict({name: value}))) for name, value in VALUES.items()}
    maps, again = [parts["counts"], parts["named"]], [part for name, part in parts.items() if name not in ("counts", "named")]
    chance, mixed = random.Random("late"), list[bytes]()
    for _ in range(20):
        some = [*chance.choices([*again, UNKNOWN], k=6), *maps]  # of entries of one key a dict has one
        chance.shuffle(some)
        mixed.append(b"".join(some))
    answers_as_the_library(unit, programs, harmed([b"", UNKNOWN, *parts.values(), *mixed, b"".join(parts.values())], 12, "late"))


def test_what_never_came_is_each_objects_own():
    unit = module(type_request("decode", "t.M", protobuf(BODY)))
    first, second = unit.decode(b""), unit.decode(b"")
    first.texts.append("a")
    first.counts["a"] = 1
    assert (second.texts, second.counts, second) == ([], {}, unit.M())
    assert unit.decode(unit.encode(first)) == first


def test_lists_of_other_wires_are_unchanged():
    """Where a list is there whatever the message is, nothing asks whether it is."""
    given = {"encoding": "ros1", "schema": {"t/msg/M.msg": "string[] a\nfloat64[] b"}}
    assert "has_" not in source_of(type_request("decode", "t/M", given))


def test_nothing_stays_of_a_message_that_contains_its_own_type():
    """The functions that make objects of rows refer to each other: nothing of theirs waits for the garbage collector."""
    given = protobuf("message M { string text = 1; repeated M kids = 2; map<string, M> named = 3; }")
    unit, encode = module(type_request("decode", "t.M", given)), rj.Encoder.of("t.M", **given)
    value = {"text": "a", "kids": [{"text": "b", "kids": [{}]}, {"named": {"c": {"text": "d"}}}]}
    message = bytes(encode(encode.holder_type.from_dict(value)))
    gc.collect()
    gc.disable()
    try:
        found = unit.decode(message)
        assert gc.collect() == 0
    finally:
        gc.enable()
    assert found.kids[1].named["c"].text == "d"
    assert unit.encode(found) == message


def test_cases_share_their_locals():
    """Fields that are read alike need the locals of one: a function clears all that it has when it is called."""

    def locals_of(count: int) -> int:
        fields = " ".join(f"map<int32, string> f{number} = {number};" for number in range(1, count + 1))
        unit = module(type_request("decode", "t.M", protobuf(f"message M {{ {fields} }}")))
        return unit._borrow_1.__code__.co_nlocals

    assert locals_of(21) - locals_of(1) <= 20 * 8


def test_the_object_is_whole_whatever_came():
    """All fields are set, without a call of the class: objects are compared, shown and copied as any."""
    unit = module(type_request("decode", "t.M", protobuf(BODY)))
    for message in (b"", UNKNOWN, b"\x70\x07", b"\x22\x01a"):
        found = unit.decode(message)
        made = unit.M(**{each.name: getattr(found, each.name) for each in dataclasses.fields(unit.M)})
        assert found == made == copy.copy(found) == copy.deepcopy(found)
        assert repr(found) == repr(made)
        assert unit.encode(found) == message


def test_texts_of_messages_that_may_be_absent():
    """Where a message within another begins, and where its text ends, are found in any order."""
    inner = "@mutable struct Inner { string text; unsigned short u; };"
    idl = f"module t {{ {inner} @mutable struct M {{ @optional Inner a; @optional Inner b; double d; sequence<string> texts; }}; }};"
    given = {"encoding": "cdr", "schema": {"t.idl": idl}}
    unit = module(type_request("decode", "t::M", given))
    programs = rj.Decoder.of("t::M", **given), rj.Encoder.of("t::M", **given)
    whole = {"a": {"text": "ab", "u": 1}, "b": {"text": "", "u": 2}, "d": 0.5, "texts": ["", "x"]}
    some = [{}, whole, *({name: value} for name, value in whole.items())]
    messages = [bytes(programs[1](programs[1].holder_type.from_dict(each))) for each in some]
    answers_as_the_library(unit, programs, harmed(messages, 40, "mutable"))


def test_a_field_may_be_called_unknown():
    given = protobuf("message M { repeated int32 unknown = 1; repeated string unknown_fields = 2; }")
    unit, programs = module(type_request("decode", "t.M", given)), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    parts = (b"\x08\x05", b"\x12\x01a", UNKNOWN)
    answers_as_the_library(unit, programs, [b"", *parts, b"".join(parts), b"".join(reversed(parts))])


@pytest.mark.parametrize("second", ["map<sfixed32, N> g = 4;", "map<string, N> g = 4; map<int64, N> h = 6;"])
def test_maps_that_share_the_messages_of_a_type_that_contains_itself(second):
    """What several fields need is made for the message, whichever of them comes."""
    options = protobuf(
        f"message M {{ repeated N a = 1; int32 b = 2; map<int64, N> f = 3; {second} repeated sint64 i = 5 [packed = false]; }}"
        "message N { M m = 1; oneof o { int32 x = 2; M y = 3; } map<int64, string> t = 4; }"
    )
    decode, encode = rj.Decoder.of("t.M", **options), rj.Encoder.of("t.M", **options)
    inner = {"m": {"b": 1, "f": {2: {"x": 3}}}, "t": {1: "a"}}
    keys = {"g": {"a" if "string" in second else 1: inner}, "h": {1: inner}}
    values = [{}, {"b": 1}, {"a": [inner]}, {"f": {1: inner}}, {"a": [inner, {}], "f": {1: inner, 2: {}}, "i": [-1]}, {"g": keys["g"]}]
    messages = [bytes(encode(encode.holder_type.from_dict(each))) for each in values]
    if "h" in second:
        messages.append(bytes(encode(encode.holder_type.from_dict({**keys, "f": {}}))))
    unit = module(type_request("decode", "t.M", options))
    answers_as_the_library(unit, (decode, encode), harmed(messages, 10, second))
