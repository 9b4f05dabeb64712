"""Whatever a text holds, a schema or a SchemaError comes out, and soon."""

from __future__ import annotations

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosetta_jit.errors import SchemaError
from tests.frameworks.ros.ros_files import alone

BIG = 100_000
SEPARATOR = "=" * 80 + "\nMSG: "
SOUP = ["int32", "string", "wstring<=3", "Header", "time", "pkg/Foo", "a", "B", "[]", "[<=2]", "[3]", "=", "#", "'", '"', "\\", "1", "-0x1"]
SOUP += ["@optional", "\n", "\n", "\t", " ", "\r", "[1, 2]", "MSG: a/B", "=" * 80, "\0", "é", "\u2028", "1e5", "nan", "True"]


def outcome(text, dialect):
    try:
        alone(text, "pkg/Foo.msg", dialect)
    except SchemaError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
@settings(max_examples=100, deadline=None)
@given(st.lists(st.sampled_from(SOUP), max_size=30), st.sampled_from(["", " "]))
def test_token_soup(dialect, words, between):
    outcome(between.join(words), dialect)


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
@settings(max_examples=100, deadline=None)
@given(st.text(max_size=60))
def test_any_text(dialect, text):
    outcome(text, dialect)
    outcome(f"string A={text}\nstring b {text}\nint8[3] c {text}\n{text} d\n{SEPARATOR}{text}", dialect)


HOSTILE = {
    "nothing but lines": "\n" * BIG,
    "wrong lines": "x\n" * BIG,
    "nul": "\0" * BIG,
    "long line": "int8 " + "a" * BIG,
    "long type": "a" * BIG + " a",
    "long package": "a/" * BIG + "b c",
    "brackets": "int8" + "[" * BIG + " a",
    "bounds": "string" + "<=" * BIG + " a",
    "long length": "int8[" + "9" * BIG + "] a",
    "long number": "int64 A=" + "9" * BIG,
    "long hexadecimal": "int64 A=0x" + "f" * BIG,
    "long float": "float64 A=" + "9" * BIG,
    "dots and signs": "float64 A=" + "+." * BIG,
    "quotes": 'string A="' + '\\"' * BIG,
    "quotes in an array": "string[] a [" + "'\\'" * BIG,
    "commas": "string[] a [" + "," * BIG + "]",
    "elements": "string[] a [" + "b, " * BIG + "c]",
    "underscores": "int8 a" + "_a" * BIG + "_",
    "upper case": "int8 A" + "_A" * BIG + "_=1",
    "comments": "#" * BIG,
    "annotations": "@optional " * BIG,
    "separators": ("=" * 80 + "\n") * (BIG // 80),
    "one definition again and again": "int8 a\n" + (SEPARATOR + "a/B\nint8 a\n") * (BIG // 100),
    "many definitions": "".join(f"{SEPARATOR}a/B{i}\nB{i + 1} a\n" for i in range(BIG // 100)) + f"{SEPARATOR}a/B{BIG // 100}\nint8 a\n",
    "a cycle of many": "".join(f"{SEPARATOR}a/B{i}\nB{(i + 1) % 1000} a\n" for i in range(1000)),
    "doubled at each level": "".join(f"{SEPARATOR}a/B{i}\nB{i + 1} a\nB{i + 1} b\n" for i in range(40)) + f"{SEPARATOR}a/B40\nint8 a\n",
    "unknown messages": "".join(f"a/B{i} a{i}\n" for i in range(BIG // 10)),
    "many fields": "".join(f"int8 a{i}\n" for i in range(BIG // 2)),
    "lone surrogates": "int8 \ud800\nstring A=\ud800",
    "digits of other scripts": "int8[\u0663] a\nint8 A=\u0663",
}


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE.keys())
def test_hostile_texts_end_in_time(text, dialect):
    start = time.process_time()
    report = outcome(text, dialect)
    assert time.process_time() - start < 30
    assert len(report) < 100_000


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_files_without_end(dialect):
    """A message that always needs one more."""

    class Endless(dict):
        def __contains__(self, name):
            return "msg" in name.split("/")

        def __getitem__(self, name):
            return f"pkg/M{int(name.removesuffix('.msg').rsplit('M', 1)[1]) + 1} x"

    with pytest.raises(SchemaError, match="too-many"):
        alone("pkg/M0 x", "pkg/Foo.msg", dialect, others=Endless())
