"""Texts of generated Python that mappings cut out of others."""

from __future__ import annotations

import struct
from typing import Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of, type_request
from tests.generate.python import module

MAPPING = 'import "w/W"\nimport "b.proto"\ndata-holder: b.H\nwire-schema: w/W\nunpack-rules:\n  .o = {}\n'


@pytest.mark.parametrize("rule", ["slice(.t, 1, 1)", "slice(.t, 0, 2)", "slice(slice(.t, 0, 2), 1, 1)", "slice(.t, 1, 3)"])
def test_parts_of_texts_that_stay_where_they_are(rule):
    """Where such a part lies and how long it is are numbers that nothing else needs."""
    schema = {
        "w/msg/W.msg": "string t",
        "b.proto": 'syntax = "proto3"; package b; message H { string o = 1; }',
        "m.mapping": MAPPING.format(rule),
    }
    wire: Any = {"encoding": "ros1", "schema": schema}
    unit, decode = module(request_of("decode", wire, mapping="m.mapping"), ("decode",)), rj.Decoder("m.mapping", **wire)
    for text in (b"abc", b"\xc3\xa9b", b"a\xc3\xa9", b"ab"):
        message = struct.pack("<I", len(text)) + text
        try:
            wanted: Any = decode(message).o
        except rj.DecodeError as error:
            wanted = error.kind, error.path, error.offset
        try:
            found = unit.decode(message).o
        except unit.DecodeError as error:
            found = error.kind, error.path, error.offset
        assert found == wanted


PROTO = {"t.proto": 'syntax = "proto3"; package t; message T { string a = 1; repeated string b = 2; map<string, string> c = 3; T d = 4; }'}


def test_texts_that_are_no_utf8_are_refused():
    """Lone surrogates stand for bytes that are no UTF-8: they are written where a text may have such bytes, and nowhere else."""
    ros: Any = {"encoding": "ros1", "schema": "string a\nstring[] b\n"}
    protobuf: Any = {"encoding": "protobuf", "schema": PROTO}
    for given, type_ in ((ros, "t/T"), (protobuf, "t.T")):
        unit, encode = module(type_request("encode", type_, given)), rj.Encoder.of(type_, **given)
        for wrong in ({"a": "\udc80"}, {"b": ["a", "é\udcff"]}):
            with pytest.raises(unit.EncodeError, match=r"range.*surrogates not allowed"):
                unit.encode(unit.T(**wrong))
            with pytest.raises(ValueError, match="surrogates not allowed"):
                encode.holder_type.from_dict(wrong)
        assert unit.decode(unit.encode(unit.T(a="é", b=["", "日本"]))) == unit.T(a="é", b=["", "日本"])
    for wrong in (unit.T(c={"\udc80": ""}), unit.T(c={"": "\udc80"}), unit.T(d=unit.T(a="\udc80"))):
        with pytest.raises(unit.EncodeError, match="range"):
            unit.encode(wrong)
    options: Any = {**ros, "lenient": ["text"]}
    lenient = module(type_request("encode", "t/T", options))
    message = struct.pack("<I", 2) + b"\x80a" + struct.pack("<II", 1, 1) + b"\xff"
    assert lenient.decode(message) == lenient.T(a="\udc80a", b=["\udcff"])
    assert lenient.encode(lenient.decode(message)) == message
