"""Lists and maps without elements, in generated Python: of messages within others, which may have many."""

from __future__ import annotations

import copy
import pickle
import random

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module, protobuf, source_of

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


MANY = " ".join(f"repeated {('string', 'double', 'sint32', 'Leaf')[number % 4]} l{number} = {number};" for number in range(1, 18))
OF_MANY = f"""
    message Leaf {{ repeated string texts = 1; }}
    message Inner {{ {MANY} }}
    message Row {{
        {MANY} map<int32, string> names = 30; int32 number = 31; string text = 32; optional bool said = 33; repeated Inner in = 34;
    }}
    message Other {{ {MANY} oneof which {{ Inner case = 35; string word = 36; int32 number = 37; }} Inner one = 38; }}
    message M {{ repeated Row rows = 1; repeated Other others = 3; }}
"""
OF_ROWS = {"l1": [0.5], "l2": [1], "l4": ["ä"], "l16": [""], "l3": [{"texts": ["a"]}], "names": {1: "one"}, "in": [{"l8": ["a"]}, {}]}
BESIDES = {"number": 7, "text": "ä", "said": True}
OF_OTHERS = [
    {},
    {"word": "ä"},
    {"number": 0},
    {"case": {"l1": [0.5]}},
    {"one": {}},
    {"l4": ["a"], "number": 1},
    {"l16": [""], "one": {"l2": [1]}},
]


@pytest.fixture(
    scope="module",
    params=[pytest.param(NO_WISHES, id="lists"), pytest.param(Wishes(numpy=True), id="arrays", marks=pytest.mark.campaign)],
)
def unit(request):
    return module(type_request("decode", "t.M", protobuf(OF_MANY)), BOTH, request.param)


def test_rows_with_many_lists(unit):
    """Rows that bring none of their lists beside such that do; lists that come without elements; unknown fields; and broken."""
    given, chance, messages = protobuf(OF_MANY), random.Random("many"), [b"", b"\x0a\x00", b"\x0a\x02\x0a\x00", b"\x0a\x02\x70\x05\x0a\x00"]
    programs = rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given)

    def row():
        lists = chance.sample([*OF_ROWS], chance.randrange(3))
        return {name: value for name, value in (OF_ROWS | BESIDES).items() if name in lists or (name in BESIDES and chance.random() < 0.5)}

    for _ in range(12):
        values = {"rows": [row() for _ in range(chance.randrange(8))], "others": chance.sample(OF_OTHERS, chance.randrange(4))}
        messages.append(bytes(programs[1](programs[1].holder_type.from_dict(values))))
    answers_as_the_library(unit, programs, harmed(messages, 12, "many"))


def test_rows_get_their_lists_when_somebody_asks(unit):
    message = unit.encode(unit.M(rows=[unit.Row(number=7, text="ä"), unit.Row(l4=["a"]), unit.Row(said=False)]))
    found = unit.decode(message)

    def lacking():
        return [unit._lacking.get(type(each), 0) for each in found.rows]

    assert lacking() == [0b11, 0b10, 0b11]
    assert (found.rows[0].number, found.rows[0].text, found.rows[2].said) == (7, "ä", False)
    assert unit.encode(found) == message
    assert lacking() == [0b11, 0b10, 0b11]
    found.rows[0].l4.append("b")
    found.rows[2].names[1] = "one"
    assert lacking() == [0b10, 0b10, 0b01]
    assert [each.l4 for each in found.rows] == [["b"], ["a"], []]
    assert found.rows == [unit.Row(number=7, text="ä", l4=["b"]), unit.Row(l4=["a"]), unit.Row(said=False, names={1: "one"})]
    assert unit.decode(unit.encode(found)) == found
    assert pickle.loads(pickle.dumps(unit.decode(message))) == copy.deepcopy(unit.decode(message)) == unit.decode(message)  # noqa: S301 - of ourselves
    assert repr(unit.decode(message)) == repr(copy.copy(unit.decode(message)))


def test_rows_without_lists_may_be_anywhere():
    """An object of a row is what any other one of its class is, wherever a program puts it."""
    leaf = "message Leaf { repeated string texts = 1; }"
    body = f"{leaf} message Row {{ {MANY} }} message M {{ repeated Row rows = 1; Row one = 6; map<int32, Row> named = 7; }}"
    unit = module(type_request("decode", "t.M", protobuf(body)))
    (row,) = unit.decode(b"\x0a\x00").rows
    assert unit.encode(unit.M(one=row)) == b"\x32\x00"
    (row,) = unit.decode(b"\x0a\x00").rows
    assert unit.decode(unit.encode(unit.M(named={1: row}))) == unit.M(named={1: unit.Row()})


def test_rows_say_nothing_of_lists_that_stay_empty():
    text = source_of(type_request("decode", "t.M", protobuf(BODY)))
    assert "if rows_texts_used > first" in text


def test_each_row_has_lists_of_its_own():
    unit = module(type_request("decode", "t.M", protobuf(BODY)))
    found = unit.decode(unit.encode(unit.M(rows=[unit.Row(), unit.Row()])))
    found.rows[0].texts.append("a")
    found.rows[0].names[1] = "one"
    assert found.rows[1] == unit.Row()


def test_rows_with_groups_of_lists():
    """Rows of four groups of lists, and more fields than one match has cases: each list alone, several, all; and broken."""
    kinds, names = ("string", "bytes", "bool", "double", "sint32", "Leaf"), [f"l{number}" for number in range(1, 37)]
    values = {
        "string": ["ä"],
        "bytes": [b"x", b""],
        "bool": [True, False],
        "double": [0.5],
        "sint32": [-1, 300],
        "Leaf": [{"number": 7}, {}],
    }
    lists = " ".join(f"repeated {kinds[number % 6]} l{number} = {number};" for number in range(1, 37))
    given = protobuf(f"""
        message Leaf {{ int32 number = 1; }}
        message Row {{ {lists} int32 number = 101; Leaf leaf = 102; }}
        message Deep {{ repeated Row rows = 1; }}
        message M {{ repeated Row rows = 101; repeated Deep deep = 102; }}
    """)
    unit, programs = module(type_request("decode", "t.M", given)), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    chance = random.Random("groups")

    def row(some):
        besides = {"number": 7, "leaf": {"number": 1}} if chance.random() < 0.5 else {}
        return {name: values[kinds[int(name[1:]) % 6]] for name in some} | besides

    def encoded(message):
        return bytes(programs[1](programs[1].holder_type.from_dict(message)))

    messages = list[bytes]()
    for count in (0, 1, 2, 8, 36):
        rows = [row(chance.sample(names, chance.choice((0, count)))) for _ in range(3)]
        messages.append(encoded({"rows": rows, "deep": [{"rows": rows}]}))
    answers_as_the_library(unit, programs, [encoded({"rows": [row([name]) for name in names]}), *harmed(messages, 12, "groups")])
