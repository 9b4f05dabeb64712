"""Drafted schemas describe the messages that they were drafted from, and say what varied."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosetta_jit.errors import DecodeError, SchemaError
from rosetta_jit.frameworks.yarp.bottle import read, write
from rosetta_jit.frameworks.yarp.bottle_schema.front_end import parse
from rosetta_jit.frameworks.yarp.drafting.infer import infer
from rosetta_jit.frameworks.yarp.limits import MAX_PLACES
from rosetta_jit.frameworks.yarp.tags import DIALECTS, YARP3, YARP4
from rosetta_jit.frameworks.yarp.text import parse_text
from rosetta_jit.frameworks.yarp.tree import Dict, List, Value, specialised
from rosetta_jit.model.expr import Literal
from rosetta_jit.model.types import Array, Map, Struct
from rosetta_jit.source import Source

VECTORS = Path(__file__).parents[2] / "vectors" / "yarp"


def nothing(path):
    return None


def drafted(text):
    return parse(Source("draft", text), nothing).types["x"]


def describes(type_, item):
    """Whether an item is of a type: what an encoding of the drafted schema would accept."""
    match type_, item:
        case Struct(_, fields), Dict(List(pairs)):
            values = {pair.items[0].value.decode(): pair.items[1] for pair in pairs}
            return values.keys() == {field.option("key") for field in fields} and all(
                describes(field.type, values[field.option("key")]) for field in fields
            )
        case Map(_, value), Dict(List(pairs)):
            return all(describes(value, pair.items[1]) for pair in pairs)
        case Struct(_, fields), List(items):
            return fits(fields, items)
        case Array(element, length), List(items):
            return length in {None, len(items)} and all(describes(element, item) for item in items)
        case _, Value(tag):
            return getattr(type_, "spelling", None) == tag
        case _:
            return False


def fits(fields, items):
    if fields and fields[-1].option("rest"):
        *fields, rest = fields
        head, tail = items[: len(fields)], List(items[len(fields) :])
        return fits(fields, head) and describes(rest.type, tail)
    return len(fields) == len(items) and all(
        describes(field.type, item) and field.constant in {None, Literal(getattr(item, "value", None))}
        for field, item in zip(fields, items, strict=True)
    )


def entries():
    for name in ("yarp3", "yarp4", "yarp2012", "thrift-yarp3", "thrift-yarp4"):
        for entry in json.loads((VECTORS / f"{name}.json").read_text()):
            if entry.get("tree", ()) is not None and entry["name"] != "struct_All":
                yield pytest.param(bytes.fromhex(entry["hex"]), name.removeprefix("thrift-"), id=f"{name}-{entry['name']}")


@pytest.mark.parametrize(("data", "dialect"), list(entries()))
def test_describes_every_vector(data, dialect):
    struct = drafted(infer([data], name="x", encoding=dialect))
    assert describes(struct, read(data, DIALECTS[dialect]))
    assert drafted(infer([data, data], name="x", encoding=dialect)) == struct


def of(*texts, dialect=YARP4):
    return infer([write(parse_text(text, dialect), dialect) for text in texts], name="x", encoding=dialect.name)


def test_drafts_what_a_person_can_go_on_with():
    assert of("[set] 1 (0.5 1.5) up {1 2}", "[set] 1 (2.5) down {1 2}", "[set] 1 () x {1 2}") == (
        "; Drafted from 3 messages: name the fields, add units, and see what never varied.\n"
        "\n"
        '"x"\n'
        "(\n"
        '  ("f0" :vocab32 :|set|)  ; the same in all 3\n'
        '  ("f1" :int32)  ; always 1\n'
        '  ("f2" (:list :float64))  ; 0 to 2 elements of 0.5 to 2.5\n'
        '  ("f3" :string)  ; 1 to 4 bytes\n'
        '  ("f4" :blob))  ; always {1 2}\n'
    )


@pytest.mark.parametrize(
    ("texts", "fields"),
    [
        (["1 2", "1 2 3"], '("f0" (:list :int32) :rest)'),
        (["", "1"], '("f0" (:list :int32) :rest)'),
        (["(1 2)", "(3 4)"], '("f0" (:list :int32 (:length 2)))'),
        (["(1 a)"], '("f0" (:bottle ("f0" :int32) ("f1" :string)))'),
        (["((1) (2 3))"], '("f0" (:list (:list :int32) (:length 2)))'),
        (["((1 a) (2 b))"], '("f0" (:list (:bottle ("f0" :int32) ("f1" :string)) (:length 2)))'),
        (["(() 1)"], '("f0" (:bottle ("f0" (:bottle)) ("f1" :int32)))'),
        (["()"], '("f0" (:bottle))'),
        (["true", "false"], '("f0" :vocab32)'),
        (["[a]", "[b]"], '("f0" :vocab32)'),
        ([""], ""),
    ],
)
def test_drafts_types(texts, fields):
    assert drafted(of(*texts)) == drafted(f'"x" ({fields})')


def pairs(**values):
    return Dict(List(tuple(specialised([Value("string", key.encode()), value]) for key, value in values.items())))


def test_drafts_dicts():
    one, two = Value("int32", 1), Value("int32", 2)
    a, b = (write(List((item,)), YARP3) for item in (pairs(a=one, b=two), pairs(b=one, a=one)))
    c = write(List((pairs(c=one),)), YARP3)
    assert drafted(infer([a, b], name="x")) == drafted('"x" (("f0" (:dict ("a" :int) ("b" :int))))')
    assert drafted(infer([a, c], name="x")) == drafted('"x" (("f0" (:dict :int)))')
    odd = write(List((pairs(**{'left "cam"': one, "left cam ": one}),)), YARP3)
    assert [field.option("key") for field in drafted(infer([odd], name="x")).fields[0].type.fields] == ['left "cam"', "left cam "]


def test_many_elements_are_a_list():
    assert drafted(of(" ".join("1" * (MAX_PLACES + 1)))) == drafted(f'"x" (("f0" (:list :int (:length {MAX_PLACES + 1})) :rest))')


@pytest.mark.parametrize(
    ("texts", "told"),
    [
        (["1", "2", "a"], "message 3 .* at `.f0`: int32 and string"),
        (["(1 a)", "(1 2)"], "message 2 .* at `.f0.f1`: string and int32"),
        (["1 a", "1 a 2"], "message 2 .* at `.`: 2 elements and 3"),
    ],
)
def test_says_which_message_differs_and_where(texts, told):
    with pytest.raises(SchemaError, match=told.replace(" .* ", r"(?s:.*)")):
        of(*texts)


def test_says_which_message_is_no_bottle():
    good = write(parse_text("1", YARP3), YARP3)
    with pytest.raises(DecodeError, match="message 2: 1 bytes are left over"):
        infer([good, good + b"\0"], name="x")


def test_refuses_what_it_cannot_describe():
    for messages, name in (([], "x"), ([write(List((), None), YARP3)], "not a name")):
        with pytest.raises(SchemaError):
            infer(messages, name=name)
    with pytest.raises(SchemaError, match="dict"):
        infer([write(List((Dict(specialised([Value("int32", 1)])),)), YARP3)], name="x")


def test_unprintable_keys_are_described_by_their_values_alone():
    one, text = Value("int32", 1), Value("string", b"")
    assert drafted(infer([write(List((pairs(**{"\x1b": one}),)), YARP3)], name="x")) == drafted('"x" (("f0" (:dict :int)))')
    with pytest.raises(SchemaError, match=r"at `\.f0`: int32 and string"):
        infer([write(List((pairs(**{"\x1b": one, "b": text}),)), YARP3)], name="x")


def test_dialects_may_be_mixed():
    messages = [write(parse_text("a 0.5", dialect), dialect) for dialect in DIALECTS.values()]
    assert drafted(infer(messages, name="x")) == drafted('"x" (("f0" :string) ("f1" :double))')


HOSTILE = st.recursive(
    st.one_of(
        st.builds(Value, st.just("string"), st.binary(max_size=8)),
        st.builds(Value, st.just("vocab32"), st.integers(-(2**31), 2**31 - 1)),
        st.builds(Value, st.just("float32"), st.just(float("nan"))),
    ),
    lambda items: st.one_of(
        st.lists(items, max_size=3).map(specialised),
        st.dictionaries(st.text(max_size=4).filter(str.isprintable), items, max_size=3).map(lambda found: pairs(**found)),
    ),
    max_leaves=8,
)


@given(st.lists(HOSTILE, max_size=4))
def test_any_message_is_described(items):
    bottle = specialised(items)
    text = infer([write(bottle, YARP3)], name="x", encoding="yarp3")
    assert describes(drafted(text), bottle)
    assert all(line.isprintable() for line in text.split("\n"))
