"""Messages of protobuf that may lack most of their fields, in generated Python: the object is made first, and gets what comes."""

from __future__ import annotations

import random
from typing import Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module, protobuf, source_of

KINDS = {
    "string": "text",
    "bytes": b"b\xff",
    "bool": True,
    "float": 0.5,
    "double": -0.0,
    "fixed32": 7,
    "sfixed64": -8,
    "int32": -1,
    "uint64": 1 << 63,
    "sint32": -300,
    "E": 1,
}
"""A value of each kind of field."""
SCHEMA = """
    enum E { ZERO = 0; ONE = 1; }
    message Inner { int32 a = 1; string text = 2; repeated Inner2 many = 3; }
    message Inner2 { string text = 1; repeated int32 numbers = 2; }
"""

MAPS = ("map", "entries")


def fields(label: str, first: int) -> str:
    return " ".join(f"{label} {kind} {label or 'f'}{number} = {number};" for number, kind in enumerate(KINDS, first))


def schema(label: str) -> str:
    """A message of a field of each kind, twice, and of all that becomes an object in the end."""
    rest = """
        repeated string names = 100; repeated double numbers = 101; Inner inner = 102; repeated Inner inners = 103;
        map<string, int32> map = 104; oneof which { int32 one = 105; string other = 106; Inner third = 107; }
        map<int32, Inner> entries = 108;
    """
    return f"{SCHEMA} message M {{ {fields(label, 1)} {fields('repeated', 31)} {fields(label, 51)} {rest} }}"


def values(label: str) -> list[dict[str, Any]]:
    own = {f"{label or 'f'}{number}": value for first in (1, 51) for number, value in enumerate(KINDS.values(), first)}
    lists = {f"repeated{number}": [value, value] for number, value in enumerate(KINDS.values(), 31)}
    inner = {"a": 1, "text": "x", "many": [{"text": "y", "numbers": [1, 2]}, {}]}
    rest = {
        "names": ["a", ""],
        "numbers": [1.5],
        "inner": inner,
        "inners": [inner, {}],
        "map": {"a": 1},
        "third": inner,
        "entries": {1: inner},
    }
    chance = random.Random(label)
    some = [{name: own[name] for name in chance.sample([*own], count)} for count in (1, 1, 2, 5)]
    return [{}, *some, own, lists, rest, {**own, **lists, **rest, "other": "z"}, {"one": 0}]


@pytest.mark.parametrize("wishes", [NO_WISHES, Wishes(numpy=True)])
@pytest.mark.parametrize("label", ["", "optional"])
def test_what_comes_of_many_fields(label, wishes):
    """None, few and all of them; twice, the last one of which stands; with others that the schema does not know; and broken."""
    given = protobuf(schema(label))
    programs = rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given)
    request = type_request("decode", "t.M", given)
    assert "made = _new(M)" in source_of(request, BOTH, wishes)
    unit, (_, encode) = module(request, BOTH, wishes), programs
    all_of, without_maps = values(label), [{name: value for name, value in each.items() if name not in MAPS} for each in values(label)]
    messages, parts = ([bytes(encode(encode.holder_type.from_dict(each))) for each in some] for some in (all_of, without_maps))
    twice = [one + b"\xf8\x07\x05" + other for one in parts for other in parts]  # of entries of one key a dict has one
    answers_as_the_library(unit, programs, [*harmed(messages, 30, label), *twice])


def test_defaults_are_each_objects_own():
    unit = module(type_request("decode", "t.M", protobuf(schema(""))))
    one, other = unit.decode(b""), unit.decode(b"")
    assert one == other == unit.M()
    one.names.append("x")
    one.map["y"] = 1
    assert other == unit.M()
    assert unit.encode(other) == b""


@pytest.mark.parametrize("label", ["", "optional"])
def test_numbers_are_asked_for_what_they_are_where_they_are_no_defaults(label):
    """Zeros of other objects, and of no bits; what is no number at all is refused, whether it is true or not."""
    unit = module(type_request("decode", "t.M", protobuf(schema(label))))
    kinds = {kind: f"{label or 'f'}{number}" for number, kind in enumerate(KINDS, 1)}
    for kind, value in (
        ("double", float("0")),
        ("double", 0),
        ("float", False),
        ("int32", False),
        ("string", str(b"", "ascii")),
        ("bytes", bytearray()),
    ):
        target = unit.M(**{kinds[kind]: value})
        assert (unit.encode(target) == b"") is (label == "")
    assert unit.encode(unit.M(**{kinds["double"]: -0.0})) != b""
    for kind, wrong in (
        ("int32", ""),
        ("int32", 0.0),
        ("double", ""),
        ("string", 0),
        ("string", b""),
        ("bytes", 0),
        ("fixed32", []),
        ("E", 0.0),
    ):
        with pytest.raises(unit.EncodeError) as caught:
            unit.encode(unit.M(**{kinds[kind]: wrong}))
        assert caught.value.kind == "range"
    for name in ("map", "names", "numbers", "entries"):
        for wrong in (None, 0, False):
            with pytest.raises(unit.EncodeError):
                unit.encode(unit.M(**{name: wrong}))


def test_presence_words_that_nothing_asks_for_are_not_kept():
    """Where all fields say by themselves whether they have come; a message that is made in the end asks its word."""
    inner = "message S { int32 n = 1; optional int32 m = 2; }"
    for body, is_kept in (
        (" ".join(f"S f{each} = {each + 1};" for each in range(9)), False),
        (" ".join(f"optional int32 f{each} = {each + 1};" for each in range(9)), False),
        ("optional int32 f0 = 1; S f1 = 2;", True),
    ):
        given = protobuf(f"{inner} message M {{ {body} }}")
        request, programs = type_request("decode", "t.M", given), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
        text = source_of(request)
        assert ("m_presence_0 = present" in text) == is_kept
        good = [b"", b"\x0a\x02\x08\x05\x12\x00", b"\x08\x05\x12\x02\x08\x01", b"\x08\x00", b"\x42\x00\x0a\x02\x10\x00"]
        answers_as_the_library(module(request), programs, harmed(good, 20, body))
