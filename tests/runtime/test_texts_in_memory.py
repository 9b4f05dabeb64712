"""Texts of every kind that CPython has in memory: those of ASCII are copied from behind their heads, all others as UTF-8."""

from __future__ import annotations

import sys
from ctypes import string_at

import pytest

import rosetta_jit as rj
from rosetta_jit.runtime.attributes.code import ASCII_BYTES, ASCII_FLAGS, OFFSETS, library

pytestmark = pytest.mark.skipif(library() is None, reason="this Python is none that compiled code knows")

SCHEMA = {"t.proto": 'syntax = "proto3"; package t; message T { string one = 1; repeated string many = 2; }'}
KINDS = {
    "empty": "",
    "one letter": "a",
    "ASCII": "sensor_frame",
    "made at run time": "sensor_frame".upper(),
    "interned": sys.intern("base_link"),
    "long": "".join(map(str, range(5000))),
    "zeros": "a\0b\0",
    "the last of ASCII": "\x7f" * 3,
    "the first behind it": "\x80",
    "Latin": "é" * 7,
    "of two bytes": "漢字" * 5,
    "of four bytes": "a🚀b",
}


class Derived(str):
    __slots__ = ()


@pytest.fixture(scope="module")
def decoder():
    return rj.Decoder.of("t.T", imports=["t.proto"], schema=SCHEMA, encoding="protobuf")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("type_", [str, Derived])
def test_texts_are_set_and_appended(decoder, kind, type_):
    text, made = type_(KINDS[kind]), decoder.new()
    for _ in range(2):  # what has been asked for its UTF-8 keeps it
        made.one = text
        made.many.extend([text, "x", text])
        assert made.one == KINDS[kind]
        text.encode()
    assert list(made.many) == [KINDS[kind], "x", KINDS[kind]] * 2
    assert decoder(made.SerializeToString()) == made


@pytest.mark.parametrize("wrong", ["\ud800", "abc\udfff", "é\udc80", 1, None])
def test_what_is_no_text_changes_nothing(decoder, wrong):
    made = decoder.new()
    made.one = "kept"
    made.many.append("kept")
    for write in (lambda: setattr(made, "one", wrong), lambda: made.many.extend(["a", wrong])):
        with pytest.raises((TypeError, ValueError)):
            write()
    assert (made.one, list(made.many)) == ("kept", ["kept"])


@pytest.mark.skipif(sys.version_info >= (3, 14), reason="its header is another one")
def test_ascii_lies_where_compiled_code_takes_it_from():
    assert OFFSETS["ASCII_KIND"] == ASCII_FLAGS
    for text in KINDS.values():
        if text.isascii():
            assert string_at(id(text) + ASCII_BYTES, len(text)) == text.encode()
