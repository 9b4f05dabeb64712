"""Messages of protobuf that contain their own type and must have fields, in generated Python: what is not set is named."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from tests.generate.driver import harmed
from tests.generate.python import answers_as_the_library, module, source_of

REQUIRED = """syntax = "proto2"; package t;
message M { required int32 x = 1; repeated M kids = 2; optional M only = 3; map<string, M> named = 4; required string z = 5; }
"""


def test_fields_that_messages_of_their_own_type_must_have():
    """Each message is written by a function, which names the field that is not set."""
    given = {"encoding": "protobuf", "schema": {"t.proto": REQUIRED}}
    request, decode, encode = type_request("decode", "t.M", given), rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given)
    text = source_of(request)
    assert "def _encoded_kids(" in text
    unit = module(request)
    leaf = unit.M(x=1, z="leaf")
    whole = unit.M(x=2, z="é", kids=[leaf, unit.M(x=3, z="", kids=[leaf, leaf])], only=leaf, named={"a": leaf})
    message = unit.encode(whole)
    assert unit.decode(message) == whole
    answers_as_the_library(unit, (decode, encode), harmed([message, unit.encode(leaf)], 60, "required"))
    for place in ("kids", "only", "named"):
        for without in ("x", "z"):
            wrong = unit.M(**{"x": 1, "z": "", without: None})
            target = unit.M(x=1, z="", **{place: {"kids": [leaf, wrong], "only": wrong, "named": {"a": wrong}}[place]})
            with pytest.raises(unit.EncodeError, match="required") as caught:
                unit.encode(target)
            with pytest.raises(rj.EncodeError) as wanted:
                encode(encode.holder_type.from_dict(values_of(target)))
            assert (caught.value.kind, caught.value.path) == (wanted.value.kind, wanted.value.path)


def values_of(target: Any) -> Any:
    """What an object has, as holders take it."""
    if isinstance(target, list):
        return [values_of(each) for each in target]
    if isinstance(target, dict):
        return {key: values_of(each) for key, each in target.items()}
    if not is_dataclass(target):
        return target
    named = {each.name: getattr(target, each.name) for each in fields(target)}
    return {name: values_of(value) for name, value in named.items() if value is not None and name != "unknown_fields"}
