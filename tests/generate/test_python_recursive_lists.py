"""Types that contain themselves and have many lists, in generated Python: rows set nothing of the lists that do not come."""

from __future__ import annotations

import random
from typing import Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module, protobuf, source_of

KINDS = ("int32", "string", "double", "bytes", "bool", "sint64")
ONE = f"M kid = 30; string text = 31; {' '.join(f'repeated {KINDS[at % 6]} l{at} = {at + 2};' for at in range(8))}"
FEW = protobuf(f"message M {{ repeated M kids = 1; {ONE} }}")
SEVERAL = protobuf(
    f"message M {{ repeated M kids = 1; {ONE} map<string, M> named = 40; repeated N inner = 41; }} message N {{ repeated M m = 1; }}"
)
MANY = protobuf(
    f"message M {{ repeated M kids = 1; {' '.join(f'repeated {KINDS[at % 6]} l{at} = {at + 2};' for at in range(20))} M kid = 30; }}"
)
GIVEN = {"few": FEW, "several": SEVERAL, "many": MANY}
UNKNOWN = b"\xf8\x06\x05"
VALUES = {"l0": [1, 2], "l1": ["a", ""], "l2": [0.5], "l3": [b"x"], "l4": [True], "l5": [-1]}


def objects(chance: random.Random, depth: int = 0) -> dict[str, Any]:
    """A tree of messages, most of which have no list."""
    found = {name: value for name, value in VALUES.items() if chance.random() < 0.1}
    if depth < 4 and chance.random() < 0.7:
        found["kids"] = [objects(chance, depth + 1) for _ in range(chance.randrange(4))]
    return found | ({"kid": objects(chance, depth + 1)} if depth < 4 and chance.random() < 0.2 else {})


def with_pieces(message: bytes) -> list[bytes]:
    """Messages whose member comes again: it is one, of all pieces, with others between and behind."""
    piece = b"\xf2\x01" + bytes([len(message)]) + message
    list_, texts, unknown = b"\xf2\x01\x02\x10\x07", b"\xf2\x01\x03\x1a\x01b", b"\xf2\x01\x03" + UNKNOWN
    kid = b"\x0a\x03" + UNKNOWN
    return [
        piece + piece,
        list_ + kid + piece,
        piece + kid + list_ + texts + list_,
        unknown + kid + unknown,
        texts + b"\xf2\x01\x00" + list_,
    ]


@pytest.fixture(scope="module", params=[*GIVEN])
def given(request):
    return GIVEN[request.param]


@pytest.mark.parametrize("wishes", [NO_WISHES, Wishes(numpy=True)], ids=["lists", "arrays"])
def test_trees_of_messages_that_have_few_of_their_lists(given, wishes):
    decode, encode = (of("t.M", **given) for of in (rj.Decoder.of, rj.Encoder.of))
    chance = random.Random(7)
    trees = [bytes(encode(objects(chance))) for _ in range(12)]
    small = [each for each in trees if len(each) < 100] or [b""]
    messages = [*trees, UNKNOWN, *(each for message in small for each in with_pieces(message))]
    unit = module(type_request("decode", "t.M", given), BOTH, wishes)
    answers_as_the_library(unit, (decode, encode), [*messages, *harmed(messages, 8, "7")])


def test_rows_look_up_their_lists_where_a_message_comes_in_pieces_alone(given):
    source = source_of(type_request("decode", "t.M", given))
    assert "any_kids_list = True" in source
    assert source.count("if any_kids_list:") == 1


def test_objects_in_a_tree_are_of_their_class_and_have_all_lists():
    unit = module(type_request("decode", "t.M", MANY))
    root = unit.decode(unit.encode(unit.M(kids=[unit.M(), unit.M(l0=[5]), unit.M(l19=["last"])])))
    assert [each.__class__ for each in root.kids] == [unit.M] * 3
    assert root.kids == [unit.M(), unit.M(l0=[5]), unit.M(l19=["last"])]
    assert root.kids[0].l7 == []
    root.kids[0].l7.append("more")
    assert root.kids[0] == unit.M(l7=["more"])
    assert root.kids[1].l7 == []


def test_a_message_without_rows_of_its_own_type_begins_nothing_for_them():
    wide = protobuf(f"message M {{ repeated M kids = 1; {' '.join(f'repeated {KINDS[at % 6]} l{at} = {at + 2};' for at in range(30))} }}")
    source = source_of(type_request("decode", "t.M", wide))
    called, begun = source.index(" = _borrow_1_rows("), source.index("def _borrow_1(")
    assert source[called:].splitlines()[0].endswith("if kids_used else ()")
    assert "kids_l1" not in source[begun:called]
    unit = module(type_request("decode", "t.M", wide))
    assert type(unit.decode(b"")).__mro__ == type(unit.M()).__mro__
    root = unit.decode(unit.encode(unit.M(l0=[5])))
    assert type(root) is not unit.M
    assert (root.l0, root.kids, root.l29) == ([5], [], [])
    assert unit.decode(unit.encode(unit.M(kids=[unit.M()]))) == unit.M(kids=[unit.M()])


def test_messages_of_other_types_and_maps_take_their_rows_from_those_that_are_made_apart():
    options = protobuf(
        "message M { repeated Pair pairs = 1; map<string, N> named = 2; oneof one { N first = 3; N second = 4; } N last = 5; } "
        "message Pair { N left = 1; N right = 2; } message N { int32 value = 1; repeated N kids = 2; repeated M others = 3; }"
    )
    unit = module(type_request("decode", "t.M", options))
    one, two = unit.N(value=1), unit.N(value=2, kids=[unit.N(value=3)], others=[unit.M(last=unit.N(value=4))])
    made = unit.M(pairs=[unit.Pair(left=one), unit.Pair(left=two, right=one)], named={"a": two, "b": unit.N()}, last=two)
    messages = [unit.encode(made), b"\x1a\x02\x08\x07\x22\x02\x08\x08", b"\x12\x03\x0a\x01x", b""]
    programs = rj.Decoder.of("t.M", **options), rj.Encoder.of("t.M", **options)
    assert unit.decode(messages[0]) == made
    answers_as_the_library(unit, programs, [*messages, *harmed(messages, 12, "9")])
