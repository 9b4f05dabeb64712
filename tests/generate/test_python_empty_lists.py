"""Lists and maps without elements, in generated Python: of messages within others, which may have many."""

from __future__ import annotations

import random

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes, generated
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module, protobuf

BODY = """
    message Leaf { repeated string texts = 1; repeated int32 numbers = 2; }
    message Row {
        repeated string texts = 1; repeated bytes blobs = 2; repeated bool flags = 3; repeated double numbers = 4;
        map<int32, string> names = 5; map<string, Leaf> leaves = 6; repeated Leaf many = 7; Leaf one = 8; int32 number = 9;
    }
    message M { repeated Row rows = 1; Row row = 2; map<int32, Row> named = 3; oneof which { Row either = 4; string other = 5; } }
"""
LEAF = {"texts": ["a", ""], "numbers": [1, -1]}
FIELDS = {
    "texts": ["ä"],
    "blobs": [b"x", b""],
    "flags": [True, False],
    "numbers": [0.5],
    "names": {1: "one"},
    "leaves": {"l": LEAF, "none": {}},
    "many": [LEAF, {}],
    "one": LEAF,
    "number": 7,
}


@pytest.mark.parametrize("wishes", [NO_WISHES, Wishes(numpy=True)])
def test_rows_have_some_of_their_lists(wishes):
    """None, each alone, several; messages that come in pieces, with a list in each or in one of them; and broken."""
    given = protobuf(BODY)
    request = type_request("decode", "t.M", given)
    unit, programs = module(request, BOTH, wishes), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    chance, messages = random.Random("empty"), list[bytes]()

    def row():
        return {name: value for name, value in FIELDS.items() if chance.random() < 0.3}

    for number in range(16):
        values = {"rows": [row() for _ in range(chance.randrange(4))], "row": row(), "named": {number: row()}, "either": row()}
        some = {name: value for name, value in values.items() if chance.random() < 0.7}
        messages.append(bytes(programs[1](programs[1].holder_type.from_dict(some))))
    pieces = [bytes(programs[1](programs[1].holder_type.from_dict({"row": {name: value}}))) for name, value in FIELDS.items()]
    messages += [b"".join(chance.sample(pieces, 4)) for _ in range(8)]
    answers_as_the_library(unit, programs, harmed(messages, 12, "empty"))


def test_rows_say_nothing_of_lists_that_stay_empty():
    text = generated(type_request("decode", "t.M", protobuf(BODY)), "python", BOTH, "unit")["unit.py"]
    assert "if rows_texts_used > first" in text


def test_each_row_has_lists_of_its_own():
    unit = module(type_request("decode", "t.M", protobuf(BODY)))
    found = unit.decode(unit.encode(unit.M(rows=[unit.Row(), unit.Row()])))
    found.rows[0].texts.append("a")
    found.rows[0].names[1] = "one"
    assert found.rows[1] == unit.Row()
