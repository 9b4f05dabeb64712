"""Fields that a wire may leave out: what can be absent is absent again, whatever came before."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.api.test_wires import BACKENDS

PARTS = {
    "lab/msg/Part.msg": "string name\nfloat64[] values\n",
    "lab/msg/Both.msg": "Part left\nPart right\nfloat64 sum\n",
    "both.mapping": """import "lab/msg/Both.msg"
import "lab/msg/Part.msg"
data-holder: lab/msg/Both
wire-schema left: lab/msg/Part
wire-schema right: lab/msg/Part
rules:
  same names
unpack-rules:
  .sum = 1.0
pack-rules:
  ignore .sum
""",
}


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_field_may_be_the_whole_message_of_a_wire(backend):
    decode, encode = (make("both.mapping", schema=PARTS, backend=backend) for make in (rj.Decoders, rj.Encoders))
    parts = {"left": {"name": "l", "values": [1.0, 2.0]}, "right": {"name": "r", "values": [5.0]}}
    both = encode.holder_type.from_dict({**parts, "sum": 1.0})
    messages = encode(both)
    assert decode.left(messages["left"]).to_dict() == {"left": parts["left"], "right": {"name": "", "values": []}, "sum": 1.0}
    assert decode.right(messages["right"]) == both
    assert decode.mapping.laws.messages.kind == "exact"


CASES = {
    "p.proto": """syntax = "proto3"; package p;
message V { double x = 1; optional double y = 2; }
message In { V v = 1; map<string, int32> m = 2; repeated V vs = 3; oneof o { V a = 4; string b = 5; } }
message Out { V one = 1; V two = 2; map<string, int32> m = 3; repeated V vs = 4; oneof o { V a = 5; string b = 6; } V both = 7; }""",
    "p.mapping": """import "p.proto"
data-holder: p.Out
wire-schema one: p.In
wire-schema two: p.In
unpack-rules:
  ignore rest
  .m = .one.m
  .vs = .two.vs
  .both.x = .one.v.x
  .both.y = .two.v.x
  when has(.one.v)
    .one = .one.v
  end
  when has(.two.v)
    .two.x = .two.v.x
  end
  when has(.two.b)
    .b = .two.b
  else
    when has(.two.a)
      .a = .two.a
    end
  end
""",
}


def test_what_can_be_absent_is_so_again():
    decode = rj.Decoders("p.mapping", schema=CASES, backend="python")
    write = rj.Encoder.of("p.In", schema=CASES, imports=["p.proto"], backend="python")
    decode.one(write({"v": {"x": 1.0, "y": 2.0}, "m": {"k": 5}}))
    holder = decode.two(write({"v": {"x": 3.0}, "vs": [{"x": 1.0}, {"y": 2.0}], "b": "text"}))
    numbers = {"m": {"k": 5}, "vs": [{"x": 1.0}, {"x": 0.0, "y": 2.0}]}
    kept = {**numbers, "one": {"x": 1.0, "y": 2.0}, "both": {"x": 1.0, "y": 3.0}}
    assert holder.to_dict() == {**kept, "two": {"x": 3.0}, "b": "text"}
    decode.two(write({"a": {"y": 4.0}}))
    assert holder.to_dict() == {**kept, "vs": [], "a": {"x": 0.0, "y": 4.0}, "both": {"x": 1.0, "y": 0.0}}
    decode.two(write({}))
    decode.one(write({}))
    assert holder.to_dict() == {"m": {}, "vs": [], "both": {"x": 0.0, "y": 0.0}}
