"""The text form: what the real YARP printed and parsed, quirks included."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosetta_jit.errors import EncodeError
from rosetta_jit.frameworks.yarp.bottle import read, write
from rosetta_jit.frameworks.yarp.tags import DIALECTS, YARP3, YARP4, YARP2012
from rosetta_jit.frameworks.yarp.text import parse_text, to_text
from rosetta_jit.frameworks.yarp.tree import List, Value, specialised

VECTORS = Path(__file__).parents[2] / "vectors" / "yarp"


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4", "yarp2012"])
def test_prints_and_parses_as_yarp_does(dialect):
    for entry in json.loads((VECTORS / f"{dialect}.json").read_text()):
        if entry.get("tree", ()) is None:
            continue
        data = bytes.fromhex(entry["hex"])
        text = bytes.fromhex(entry["text_hex"]) if entry["text"] is None else entry["text"].encode()
        assert to_text(read(data, DIALECTS[dialect])) == text, entry["name"]
        if "source_text" in entry:
            assert write(parse_text(entry["source_text"], DIALECTS[dialect]), DIALECTS[dialect]) == data, entry["name"]
        if "text_parses_back" in entry:
            again = write(parse_text(text, DIALECTS[dialect]), DIALECTS[dialect])
            assert (again == data) == entry["text_parses_back"], entry["name"]


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("(1 2", ""),
        ("1 (2", "1"),
        ("a) b", ""),
        ('"a b', ""),
        ("a\\", ""),
        ("-", "0"),
        ("1-2", "1"),
        ("08", "0"),
        ("0x", "0"),
        ("0x1.8", "1.5"),
        ("1e", "0.0"),
        ("1e999", "inf"),
        ("-nan.0", '"-nan.0"'),
        ("[a b]", 'false "b]"'),
        ("[", "false"),
        ("{1 300 -1 2.7 x (1) 1e300}", "{1 44 255 2 0 0 0}"),
        ("tr\\ue", "true"),
        ('"abc"def', '"abc\\"de"'),
        ("99999999999999999999", "9223372036854775807"),
        ("-99999999999999999999", "-9223372036854775808"),
        ("null", "[null]"),
        ("()()", '(")(")'),
        (",,1,", "1"),
        ("4294967296", "4294967296"),
    ],
)
def test_reads_nonsense_as_yarp_does(text, printed):
    assert to_text(parse_text(text, YARP4)).decode() == printed


def test_long_vocabs_depend_on_the_dialect():
    assert parse_text("[hello]", YARP4).items == (Value("vocab64", 478560413032),)
    assert to_text(parse_text("[hello]", YARP3)) == b"[hell]"


def test_integers_of_2012_have_32_bits():
    assert parse_text("4294967297", YARP2012).items == (Value("int32", 1),)


def test_nesting_is_bounded():
    with pytest.raises(EncodeError, match="nesting"):
        parse_text("(" * 100_000 + ")" * 100_000, YARP4)


def test_a_negative_nan_is_printed_with_its_quirk():
    assert to_text(List((Value("float64", -float("nan")), Value("float64", float("nan"))))) == b"-nan.0 nan"


def test_a_number_of_a_million_digits_is_no_trouble():
    for digits in ("9" * 1_000_000, "0" * 1_000_000, "1." + "3" * 1_000_000):
        parse_text(digits, YARP4)


MISREAD = {b"inf", b"nan", b"null"}
"""Strings that YARP prints without quotes, and then reads as something else."""


def test_some_strings_do_not_come_back():
    for text, tag in ((b"inf", "float64"), (b"nan", "float64"), (b"null", "vocab32")):
        printed = to_text(specialised([Value("string", text)]))
        assert printed == text
        assert parse_text(printed, YARP4).unit == tag


SPEAKABLE = st.recursive(
    st.one_of(
        st.builds(Value, st.just("int32"), st.integers(-(2**31), 2**31 - 1)),
        st.builds(Value, st.just("int64"), st.integers(2**31, 2**63 - 1)),
        st.builds(Value, st.just("float64"), st.floats(allow_nan=False)),
        st.builds(Value, st.sampled_from(["string", "blob"]), st.binary(max_size=12)).filter(lambda value: value.value not in MISREAD),
    ),
    lambda items: st.lists(items, max_size=4).map(specialised),
    max_leaves=10,
)


@given(st.lists(SPEAKABLE, max_size=5).map(specialised))
def test_parsing_inverts_printing(bottle):
    assert parse_text(to_text(bottle), YARP4) == bottle


@given(st.text(alphabet='01x.e+-()[]{}"\\, abntrue\n\t', max_size=40))
def test_any_text_is_a_bottle(text):
    for dialect in (YARP3, YARP4, YARP2012):
        write(parse_text(text, dialect), dialect)
