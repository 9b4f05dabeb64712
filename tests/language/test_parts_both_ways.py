"""Parts of one text, numbers and texts, by their places: relations to all of them say together what the text is."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rosetta_jit as rj
from tests.language.pairs import BACKENDS, codes, pair

NAMES = "required string x = 1; required string y = 2;"
TEXTS = 'rules:\n  .x <-> part(.s, "/", 0)\n  .y <-> part(.s, "/", 1)\n'
MIXED = 'rules:\n  .x <-> part(.s, ";", 0)\n  .n <-> int32(integer(part(.s, ";", 2)))\n  .y <-> number(part(.s, ";", 1))\n'
EXACT = "messages: exact inverse\nholders: exact inverse"
SPELT = "a number is written in one way, however it was spelt"


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("rules", [TEXTS, 'rules:\n  .x, .y <-> split(.s, "/")\n'], ids=["parts", "split"])
def test_texts(rules, backend):
    both = pair('("s" :string)', NAMES, rules, backend)
    assert str(both.decode.mapping.laws) == EXACT
    for text, parts in (("a/bc", ("a", "bc")), ("/", ("", "")), ("é/€", ("é", "€"))):
        assert both.unpack(s=text) == dict(zip("xy", parts, strict=True))
        assert both.pack(**dict(zip("xy", parts, strict=True))) == {"s": text}
    for text in ("a/b/c", "a"):
        with pytest.raises(rj.DecodeError) as error:
            both.unpack(s=text)
        assert error.value.kind in {"index", "rejected"}
    refused = both.refused(x="a", y="b/c")
    assert (refused.kind, refused.path) == ("rejected", ".s")
    assert "a part holds the separator of the text" in str(refused)


@pytest.mark.parametrize("backend", BACKENDS)
def test_texts_and_numbers(backend):
    both = pair('("s" :string)', "required string x = 1; required double y = 2; required int32 n = 3;", MIXED, backend)
    assert both.unpack(s="left;1e3;-7") == {"x": "left", "y": 1000.0, "n": -7}
    assert both.pack(x="left", y=0.1, n=3) == {"s": "left;0.1;3"}
    laws = both.decode.mapping.laws
    assert str(laws.holders) == "exact inverse"
    assert [(loss.place, loss.why) for loss in laws.messages.losses] == [(".s", SPELT)]


@pytest.mark.parametrize("backend", BACKENDS)
def test_texts_and_constants(backend):
    """A part may be the name of an enum's constant; the separator is looked for in that."""
    rules = 'rules:\n  .x <-> part(.s, ";", 0)\n  .m <-> h.Mode(part(.s, ";", 1))\n'
    both = pair('("s" :string)', "required string x = 1; required Mode m = 2;", rules, backend)
    assert both.unpack(s="left;RGB") == {"x": "left", "m": "RGB"}
    assert both.pack(x="left", m="RGB") == {"s": "left;RGB"}
    assert str(both.decode.mapping.laws.holders) == "exact inverse"
    underscored = pair('("s" :string)', "required string x = 1; required Mode m = 2;", rules.replace('";"', '"G"'), backend)
    assert (underscored.refused(x="left", m="RGB").kind, underscored.refused(x="left", m="RGB").path) == ("rejected", ".s")


def test_a_text_of_numbers_comes_back():
    wire, holder = '("x" :double) ("y" :double)', "required string s = 1;"
    laws = pair(wire, holder, 'rules:\n  .s <-> text(.x) + ", " + text(.y)\n').decode.mapping.laws
    assert str(laws.messages) == "exact inverse"
    assert [(loss.place, loss.why) for loss in laws.holders.losses] == [(".s", SPELT)]


def test_behind_what_the_text_begins_with():
    both = pair('("s" :string)', NAMES, TEXTS.replace(".s,", 'behind(.s, "/"),'))
    assert str(both.decode.mapping.laws) == EXACT
    assert both.pack(**both.unpack(s="/robot/arm")) == {"s": "/robot/arm"}


PAIR = pair('("s" :string)', NAMES, TEXTS, "python")
LETTERS = st.text(st.sampled_from("a/;é"), max_size=5)


@given(LETTERS, LETTERS)
def test_what_is_not_refused_comes_back_to_pack(x, y):
    try:
        packed = PAIR.pack(x=x, y=y)
    except rj.EncodeError:
        assert "/" in x + y
    else:
        assert PAIR.unpack(**packed) == {"x": x, "y": y}


@given(LETTERS)
def test_what_is_not_refused_comes_back_to_unpack(text):
    try:
        held = PAIR.unpack(s=text)
    except rj.DecodeError:
        assert text.count("/") != 1
    else:
        assert PAIR.pack(**held) == {"s": text}


@pytest.mark.parametrize(
    "rules", [TEXTS.replace('"/"', '", "'), TEXTS.replace(", 0", ", 2"), TEXTS.replace('part(.s, "/", 0)', 'lower(part(.s, "/", 0))')]
)
def test_parts_that_do_not_say_what_the_text_is(rules):
    """A separator of several characters may arise where texts meet; a part is missing; a part is not there as it was."""
    assert codes('("s" :string)', NAMES, rules) == ["no-inverse"] * 2


WHOLE = {
    "a text": (
        '("s" :string)',
        "required double x = 1; required string whole = 2;",
        '  .x, .x2 <-> number(split(.s, ","))\n',
        {"s": "1.50,2"},
    ),
    "a frame": (
        '("s" :blob)',
        "required int32 x = 1; required bytes whole = 2;",
        '  .x <-> int32(signal(.s, "0|8@1+"))\n',
        {"s": b"\1\2\3\4"},
    ),
}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("case", WHOLE)
def test_a_relation_to_all_of_it_keeps_what_parts_do_not(case, backend):
    """Of several relations that could set a field the one that loses least does: what was unpacked is packed as it came."""
    wire, holder, rules, message = WHOLE[case]
    both = pair(wire, f"{holder} optional double x2 = 3;", f"rules:\n  .whole <-> .s\n{rules}", backend)
    assert both.pack(**both.unpack(**message)) == message
    assert str(both.decode.mapping.laws.messages) == "exact inverse"


def test_a_rule_for_all_parts_refuses_others_also_where_another_relation_has_the_text():
    wire, holder, rules, _ = WHOLE["a text"]
    both = pair(wire, f"{holder} optional double x2 = 3;", f"rules:\n  .whole <-> .s\n{rules}")
    with pytest.raises(rj.DecodeError, match="another number of parts"):
        both.unpack(s="1,2,3")
