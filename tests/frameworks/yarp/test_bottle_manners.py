"""Holders of YARP's types, looked at as bottles."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import rosetta_jit as rj

VECTORS = Path(__file__).resolve().parents[2] / "vectors" / "yarp"
SCHEMA = """"lab.arm"
( ("action" (:vocab :|set|) :|set|)
  ("name" :string)
  ("pose" (:bottle ("left" :double) ("n" :int)))
  ("gains" (:list :double)) )
"""


@pytest.fixture
def arm():
    holder = rj.Decoder.of("lab.arm", schema={"arm.bottle-schema": SCHEMA}, encoding="yarp4", backend="interpreter").new()
    holder.name, holder.pose.left, holder.pose.n, holder.gains = "two words", 0.5, 7, [1.0, 2.5]
    return holder


def test_elements(arm):
    assert arm.size() == 4
    assert arm.get(0).isVocab32()
    assert (arm.get(0).asString(), arm.get(1).asString(), arm.get(2).asList().get(1).asInt32()) == ("set", "two words", 7)
    assert [arm.get(3).asList().get(number).asFloat64() for number in range(3)] == [1.0, 2.5, 0.0]
    assert arm.get(4).isNull()
    assert arm.get(1).asInt32() == 0
    assert arm.tail().size() == 3


def test_text(arm):
    assert arm.toString() == '[set] "two words" (0.5 7) (1.0 2.5)'
    assert arm.get(2).toString() == "(0.5 7)"


def test_keys():
    text = '"lab.config"\n( ("pair" (:bottle ("key" :string "speed") ("value" :double))) ("word" :string "mode") ("mode" :int) )\n'
    holder = rj.Decoder.of("lab.config", schema={"c.bottle-schema": text}, encoding="yarp4", backend="interpreter").new()
    holder.pair.key, holder.pair.value, holder.word, holder.mode = "speed", 2.5, "mode", 3
    assert (holder.find("speed").asFloat64(), holder.find("mode").asInt32()) == (2.5, 3)
    assert holder.findGroup("speed").toString() == "speed 2.5"
    assert holder.check("speed")
    assert not holder.check("weight")
    assert holder.find("weight").isNull()


def test_fields_win_over_methods():
    holder = rj.Decoder.of("lab.a", schema={"a.bottle-schema": '"lab.a"\n( ("size" :int) )\n'}, backend="interpreter").new()
    holder.size = 3
    assert holder.size == 3
    assert holder.bottle().size() == 1


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_what_the_real_yarp_prints(dialect):
    schema = {"service.thrift": (VECTORS / "service.thrift").read_text()}
    for entry in json.loads((VECTORS / f"thrift-{dialect}.json").read_text()):
        if entry["name"] in ("struct_Inner", "req_set_pos", "rep_get_encs"):
            name = {"struct_Inner": "Inner", "req_set_pos": "Svc.set_pos.request", "rep_get_encs": "Svc.get_encs.reply"}[entry["name"]]
            holder = rj.Decoder.of(name, schema=schema, encoding=dialect, backend="interpreter")(bytes.fromhex(entry["hex"]))
            assert holder.toString() == entry["text"].removeprefix("(").removesuffix(")") or holder.toString() == entry["text"]
