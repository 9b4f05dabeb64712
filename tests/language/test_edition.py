"""`edition: 2012`: general rules first and special ones behind, and what none sets at its default; each forgiven place is noted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rosetta_jit as rj
from tests.language.test_parse import LISTING
from tests.language.test_rounding import PUBLISHED

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "old/msg/Pose.msg": "float32 x\nfloat32 y\nfloat32 z\n",
    "old/msg/State.msg": "string name\nint32 mode\nPose pose\nfloat32[] values\nint32 count\nbool fresh\n",
    "one/msg/State.msg": "string name\nint32 mode\nold/Pose pose\nfloat32[] values\nfloat64 wide\n",
}
HEAD = """edition: 2012
import "old/msg/State.msg"
import "one/msg/State.msg"
data-holder: old/msg/State
wire-schema: one/msg/State
unpack-rules:
"""
SENT = {"name": "a", "mode": 3, "pose": {"x": 1.0, "y": 2.0, "z": 3.0}, "values": [1.0, 2.0, 3.0, 4.0], "wide": 0.1}


def unpacked(rules: str, backend: str = "interpreter", **values: object) -> tuple[dict[str, Any], list[str]]:
    """What a message becomes, and the messages of the notes."""
    options: dict[str, Any] = {"schema": {**FILES, "m.mapping": HEAD + rules}, "encoding": "cdr", "backend": backend}
    decode = rj.Decoder("m.mapping", **options)
    write = rj.Encoder.of("one/msg/State", schema=FILES, imports=["one/msg/State.msg"], encoding="cdr", backend="interpreter")
    assert decode.mapping is not None
    found = decode(write(write.holder_type.from_dict({**SENT, **values}))).to_dict()
    return found, [each.message for each in decode.mapping.notes]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_later_rule_counts_in_each_form(backend):
    rules = """
  .name = "general"
  .mode = 1
  .pose = .pose
  .values = .values
  .count = 1
  .fresh = false
  .name = .name
  .pose.y = -1.0
  .values[1] = 9.0
  .values[1] = 7.0
  when .mode > 2
    .count = 2
    .fresh = true
  end
  .mode = .mode
"""
    found, notes = unpacked(rules, backend)
    pose = {"x": 1.0, "y": -1.0, "z": 3.0}
    assert found == {"name": "a", "mode": 3, "pose": pose, "values": [1.0, 7.0, 3.0, 4.0], "count": 2, "fresh": True}
    other, _ = unpacked(rules, backend, mode=0, values=[5.0, 6.0])
    assert (other["count"], other["fresh"], other["mode"], other["values"]) == (1, False, 0, [5.0, 7.0])
    places = [each.split("`")[1] for each in notes if "this rule counts" in each]
    assert sorted(set(places)) == [".count", ".fresh", ".mode", ".name", ".pose.y", ".values[1]"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_loops_and_their_elements(backend):
    rules = """
  len(.values) = len(.values)
  .values[0] = 100.0
  for i from 0 to len(.values)
    .values[i] = .values[i] * 2
  end
  .values[2] = -1.0
  .count = int32(len(.values))
"""
    found, notes = unpacked(rules, backend)
    assert found["values"] == [2.0, 4.0, -1.0, 8.0]
    assert found["count"] == 4
    assert [each for each in notes if "this rule counts" in each] == [
        "`.values[0]` is set before, too: this rule counts",
        "`.values[2]` is set before, too: this rule counts",
    ]


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_not_set_has_its_default(backend):
    found, notes = unpacked("  .pose.x = .wide\n", backend)
    pose = {"x": float(np.float32(0.1)), "y": 0.0, "z": 0.0}
    assert found == {"name": "", "mode": 0, "pose": pose, "values": [], "count": 0, "fresh": False}
    assert notes == ["unpacking does not set 7 fields", "a float64 becomes a float32"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_rules_for_both_directions(backend):
    text = HEAD.replace("unpack-rules", "rules") + "  .mode <-> 1\n  .mode <-> .mode\n  .pose.x <-> .wide\n  .name <-> .name\n"
    options: dict[str, Any] = {"schema": {**FILES, "m.mapping": text}, "encoding": "cdr", "backend": backend}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    read = rj.Decoder.of("one/msg/State", schema=FILES, imports=["one/msg/State.msg"], encoding="cdr", backend="interpreter")
    packed = encode(encode.holder_type.from_dict({"mode": 1, "name": "n", "pose": {"x": 0.5}}))
    assert read(packed).to_dict() == {"name": "n", "mode": 1, "pose": {"x": 0.0, "y": 0.0, "z": 0.0}, "values": [], "wide": 0.5}
    assert decode(packed).to_dict()["pose"]["x"] == 0.5


def test_without_the_statement_all_of_it_is_refused():
    text = HEAD.replace("edition: 2012\n", "") + "  same names\n  .mode = 1\n  .mode = 2\n  .pose.x = .wide\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema={**FILES, "m.mapping": text}, encoding="cdr", backend="interpreter")
    assert {each.code for each in error.value.diagnostics if each.severity == "error"} == {"set-twice", "lossy-conversion", "never-set"}


def test_what_cannot_be_told_apart_is_refused_as_ever():
    rules = (
        "  len(.values) = 4\n  for i from 0 to 4\n    .values[i] = .values[i]\n  end\n  for i from 1 to 3\n    .values[i] = 0.0\n  end\n"
    )
    with pytest.raises(rj.MappingError) as error:
        unpacked(rules)
    assert "overlap" in [each.code for each in error.value.diagnostics]


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_listing_of_the_paper_as_it_was_printed(backend):
    texts = {**PUBLISHED, "torso.mapping": f"edition: 2012\n{LISTING}"}
    decode = rj.Decoder("torso.mapping", schema=texts, encoding="yarp3", backend=backend)
    own = {"schema": PUBLISHED, "imports": ["bottle-structure-icub-torso-command.bottle-schema"]}
    write = rj.Encoder.of("yarp.icub.torso.command", encoding="yarp3", backend="interpreter", **own)
    message = write(write.holder_type.from_dict({"angles": {"a0": 0.1, "a1": 2.0, "a2": -3.0}}))
    assert list(decode(message).angles) == [np.float32(0.1), 2.0, 0.0]
    assert decode.mapping is not None
    assert [(each.code, each.notes) for each in decode.mapping.notes] == [
        ("rest", ("they are: `.angles[2]`",)),
        ("rounded", ()),
        ("rounded", ()),
    ]
