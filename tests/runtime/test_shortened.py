"""What an element has is made shorter: others that are empty, and begin where it ended, stay sound."""

from __future__ import annotations

import copy
import random

import pytest

import rosetta_jit as rj

SCHEMA = {
    "p/A.msg": "p/B[] bs\np/B one\nstring text\nfloat64[] numbers\n",
    "p/B.msg": "float64[] numbers\nstring[] names\nstring text\nuint8[] raw\np/C[] cs\n",
    "p/C.msg": "string text\nstring[] names\nfloat32[] numbers\n",
}
RECURSIVE = {
    "a.proto": """syntax = "proto3";
    message Inner { int32 x = 1; Outer outer = 2; repeated string names = 3; string text = 4; repeated Inner inners = 5; }
    message Outer { Inner inner = 1; Outer child = 2; Inner left = 3; repeated Inner inners = 4; }"""
}


@pytest.fixture(scope="module")
def programs():
    options = {"schema": SCHEMA, "imports": ["p/A.msg"], "encoding": "ros1"}
    return rj.Decoder.of("p/A", **options), rj.Encoder.of("p/A", **options)


FULL = {"numbers": [1.0, 2.0], "names": ["ab", "c"], "text": "x", "raw": b"yz", "cs": [{"text": "t", "names": ["n"], "numbers": [0.5]}] * 2}
EMPTY = {"numbers": [], "names": [], "text": "", "raw": b"", "cs": []}


def set_(name, value):
    return f"{name} = {value!r}", lambda each: setattr(each, name, value), {name: value}


CHANGES = [
    *(set_(name, EMPTY[name]) for name in EMPTY),
    *(set_(name, FULL[name][:1]) for name in ("numbers", "names", "raw", "cs")),
    set_("names", ["a", "c"]),
    *((f"clear({name!r})", lambda each, name=name: each.clear(name), {name: EMPTY[name]}) for name in EMPTY),
    ("clear()", lambda each: each.clear(), EMPTY),
    ("names.pop()", lambda each: each.names.pop(), {"names": ["ab"]}),
    ("names.clear()", lambda each: each.names.clear(), {"names": []}),
    ("names[1] = ''", lambda each: each.names.__setitem__(1, ""), {"names": ["ab", ""]}),
    ("del cs[0]", lambda each: each.cs.__delitem__(0), {"cs": FULL["cs"][1:]}),
    ("cs[1].text = ''", lambda each: setattr(each.cs[1], "text", ""), {"cs": [FULL["cs"][0], {**FULL["cs"][1], "text": ""}]}),
]


@pytest.mark.parametrize(("change", "wanted"), [each[1:] for each in CHANGES], ids=[each[0] for each in CHANGES])
@pytest.mark.parametrize("behind", [[EMPTY], [EMPTY, FULL], [{**EMPTY, "names": [""], "cs": [{"text": "", "names": [""], "numbers": []}]}]])
def test_elements_behind_one_that_is_shortened_can_be_encoded(programs, change, wanted, behind):
    decode, encode = programs
    holder = decode(encode(decode.holder_type.from_dict({"bs": [FULL, *behind]})), decode.new())
    change(holder.bs[0])
    expected = [{**FULL, **wanted}, *behind]
    assert holder.to_dict()["bs"] == expected
    assert decode(encode(holder)).to_dict()["bs"] == expected
    holder.bs[-1].names = ["later"]
    assert decode(encode(holder)).to_dict()["bs"] == [*expected[:-1], {**expected[-1], "names": ["later"]}]


def test_messages_that_contain_each_other():
    options = {"schema": RECURSIVE, "encoding": "protobuf"}
    decode, encode = rj.Decoder.of("Outer", **options), rj.Encoder.of("Outer", **options)
    plain = {
        "inner": {"outer": {"inner": {"x": 1}, "left": {}}, "names": ["aa", "b"], "text": "t", "inners": [{"x": 2}, {}]},
        "left": {"x": 3},
    }
    data = encode(decode.holder_type.from_dict(plain))
    for change in (
        lambda holder: holder.inner.ClearField("names"),
        lambda holder: holder.inner.names.clear(),
        lambda holder: holder.inner.ClearField("inners"),
        lambda holder: holder.inner.ClearField("text"),
        lambda holder: holder.inner.Clear(),
        lambda holder: holder.ClearField("inner"),
        lambda holder: holder.inner.inners.pop(),
    ):
        holder = decode(data, decode.new())
        change(holder)
        expected = holder.to_dict()
        assert decode(encode(holder), decode.new()).to_dict() == expected


def some_text(rng):
    return "é" * rng.choice([0, 0, 1, 3]) + "x" * rng.choice([0, 1, 30])


def some(name, rng):
    """A plain value of a field of B or C."""
    match name:
        case "numbers":
            return [rng.randrange(9) * 0.5 for _ in range(rng.choice([0, 0, 1, 4]))]
        case "names":
            return [some_text(rng) for _ in range(rng.choice([0, 0, 1, 2, 5]))]
        case "text":
            return some_text(rng)
        case "raw":
            return rng.randbytes(rng.choice([0, 0, 3, 9]))
        case "cs":
            return [{each: some(each, rng) for each in ("text", "names", "numbers")} for _ in range(rng.choice([0, 0, 1, 3]))]


@pytest.mark.parametrize("seed", range(10))
def test_elements_live_as_plain_values_do(programs, seed):
    decode, encode = programs
    rng = random.Random(seed)
    holder = decode.new()
    plain = holder.to_dict()
    for _ in range(60):
        if rng.random() < 0.2:
            plain["bs"] = [{name: some(name, rng) for name in EMPTY} for _ in range(rng.randrange(4))]
            holder.bs = copy.deepcopy(plain["bs"])
        index = rng.randrange(len(plain["bs"]) + 1)
        ours, theirs = (holder.one, plain["one"]) if index == len(plain["bs"]) else (holder.bs[index], plain["bs"][index])
        if theirs["cs"] and rng.random() < 0.4:
            index = rng.randrange(len(theirs["cs"]))
            ours, theirs = ours.cs[index], theirs["cs"][index]
        name = rng.choice([*theirs])
        theirs[name] = some(name, rng)
        if rng.random() < 0.3 and isinstance(theirs[name], list):
            ours.clear(name)
            getattr(ours, name).extend(theirs[name]) if name != "numbers" else setattr(ours, name, theirs[name])
        else:
            setattr(ours, name, copy.deepcopy(theirs[name]))
        assert holder.to_dict() == plain
        data = encode(holder)
        assert decode(data, decode.new()).to_dict() == plain
        holder = decode(data, decode.new()) if rng.random() < 0.2 else holder
