"""Texts of generated Python that mappings cut out of others."""

from __future__ import annotations

import struct
from typing import Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of
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
