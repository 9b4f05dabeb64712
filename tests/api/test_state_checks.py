"""State as the checker sees it: laws, warnings, names and types."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.api.test_state import HEAD, MAPPING, decoder, files, message, outcome


def test_laws_know_of_it():
    laws = decoder("python").mapping.laws
    assert laws.messages.kind == "lossy"
    assert "state" in {loss.place: loss.why for loss in laws.messages.losses}[".position"]


def test_laws_hold_of_what_has_no_state():
    """A check that reads state is no relation; whichever field no state gets into comes back."""
    text = f"""{HEAD}state n: int64 = 0
rules:
  .speed <-> .position
  .seen <-> .seq
  .gap <-> .good
  reject "many" when n > 1
unpack-rules:
  .low = 0.0
  .note = "n"
  state n = n + 1
pack-rules:
  ignore .low
  ignore .note
"""
    decode = rj.Decoder("m.mapping", schema=files(text), encoding="yarp4", backend="python")
    assert {loss.place for loss in decode.mapping.laws.messages.losses} <= {""}
    assert [outcome(decode, message())["seen"] for _ in range(2)] == [1, 1]
    assert outcome(decode, message()) == "rejected"


def warnings_of(text):
    found = rj.Decoder("m.mapping", schema=files(text), encoding="yarp4", backend="python").mapping.warnings
    return [each.code for each in found if each.code.startswith("state")]


def test_what_no_rule_uses_is_a_warning():
    declared = MAPPING.replace("state last:", "state idle: int64 = 0\nstate last:")
    assert warnings_of(MAPPING) == []
    assert warnings_of(declared.replace(".seen = seen\n", ".seen = seen + idle\n")) == ["state-never-set"]
    assert warnings_of(declared.replace("  state last = .position", "  state last = .position\n  state idle = 1")) == ["state-never-read"]


def test_mappings_that_others_use_have_none():
    given_files = {
        "lab.proto": """syntax = "proto3"; package lab;
message Point { double x = 1; }
message Path { repeated Point points = 1; }""",
        "nav/msg/Spot.msg": "float64 east\n",
        "nav/msg/Track.msg": "Spot[] points\n",
        "spot.mapping": """import "lab.proto"
import "nav/msg/Spot.msg"
state last: float64 = 0.0
data-holder: lab.Point
wire-schema: nav/msg/Spot
unpack-rules:
  .x = .east - last
  state last = .east
""",
        "track.mapping": """import "lab.proto"
import "nav/msg/Track.msg"
data-holder: lab.Path
wire-schema: nav/msg/Track
unpack-rules:
  .points = .points via "spot.mapping"
""",
    }
    assert rj.Decoder("spot.mapping", schema=given_files).state == {"last": 0.0}
    with pytest.raises(rj.MappingError, match=r"`spot.mapping` is used by another mapping, and declares state"):
        rj.Decoder("track.mapping", schema=given_files)


def test_names_may_be_state():
    """It is a word where the grammar has it alone."""
    schemas = {
        "state.bottle-schema": '"state" (("state" :int))',
        "s.proto": 'syntax = "proto2"; message S { required int32 state = 1; }',
        "s.mapping": """import "state.bottle-schema"
import "s.proto"
parameter one: int32 = 1
state state: int32 = one
state was: int32 = 1
data-holder: S
wire-schema: state
limit: 1000
unpack-rules:
  .state = int32(.state + state) if was == 1 else state
  state was = state
  state state = state
""",
    }
    decode = rj.Decoder("s.mapping", schema=schemas, encoding="yarp4")
    write = rj.Encoder.of("state", schema=schemas, imports=["state.bottle-schema"], encoding="yarp4")
    assert [decode(write(write.holder_type.from_dict({"state": 5}))).state for _ in range(2)] == [6, 6]


def test_a_misspelt_type_is_all_that_is_told():
    files = {
        "lab/msg/A.msg": "float64 a\n",
        "n.proto": 'syntax = "proto2"; message N { required double n = 1; }',
        "n.mapping": 'import "lab/msg/A.msg"\nimport "n.proto"\ndata-holder: N\nwire-schema: lab/msg/A\nstate last: float65 = 0.0\n'
        "unpack-rules:\n  .n = .a - last\n  state last = .a\n",
    }
    with pytest.raises(rj.MappingError, match="did you mean `float64`") as raised:
        rj.Decoder("n.mapping", schema=files)
    assert [each.code for each in raised.value.diagnostics] == ["state-type"]
