"""Arrays of texts whose elements messages of several wires set: each message leaves those of the others, whatever their lengths."""

from __future__ import annotations

from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj

WIRES = ("left", "right", "head")
SCHEMAS = {
    "lab/Arm.msg": "string name\nstring[] joints\nuint8[] raw\nint8 fault\n",
    "lab/Head.msg": "string name\nint32 count\n",
    "lab/Fixed.msg": "string[3] names\n",
    "robot.proto": """syntax = "proto3"; package lab;
message Robot { repeated string names = 1; repeated string joints = 2; repeated bytes raw = 3; }""",
}
HEAD = """import "lab/Arm.msg"
import "lab/Head.msg"
wire-schema left: lab/Arm
wire-schema right: lab/Arm
wire-schema head: lab/Head
"""
MAPPING = f"""{HEAD}
import "robot.proto"
data-holder: lab.Robot
unpack-rules:
  .names = [.left.name, .right.name, .head.name + "!"]
  len(.joints) = 6
  for i from 0 to 2
    .joints[i] = .left.joints[i]
    .joints[2 + i] = .right.joints[i] if .right.fault == 0 else "none"
  end
  .joints[4] = "neck"
  .joints[5] = text(.head.count)
  len(.raw) = 2
  .raw[0] = .left.raw
  .raw[1] = .right.raw
  reject "a fault" when .left.fault > 1
  reject "a fault" when .right.fault > 1
"""
FIXED = f"""{HEAD}
import "lab/Fixed.msg"
data-holder: lab/Fixed
unpack-rules:
  ignore rest
  .names[0] = .right.name
  .names[1] = .left.name
  .names[2] = .head.name
"""
FILES = {**SCHEMAS, "robot.mapping": MAPPING, "fixed.mapping": FIXED}
TEXTS = st.text(st.characters(codec="utf-8"), max_size=40)
ARM = st.fixed_dictionaries(
    {"name": TEXTS, "joints": st.lists(TEXTS, min_size=1, max_size=2), "raw": st.binary(max_size=300), "fault": st.integers(0, 2)}
)
MESSAGES = {"left": ARM, "right": ARM, "head": st.fixed_dictionaries({"name": TEXTS, "count": st.integers(-(2**31), 2**31 - 1)})}
ARRIVALS = st.lists(st.sampled_from(WIRES).flatmap(lambda wire: st.tuples(st.just(wire), MESSAGES[wire])), max_size=12)
TYPES = {"left": "lab/Arm", "right": "lab/Arm", "head": "lab/Head"}
WRITE = {wire: rj.Encoder.of(name, schema=FILES, imports=[f"{name}.msg"], backend="python") for wire, name in TYPES.items()}


def message(wire, values):
    return WRITE[wire](WRITE[wire].holder_type.from_dict(values))


@cache
def decoders(backend):
    return rj.Decoders("robot.mapping", schema=FILES, backend=backend)


def taken(wire, values, seen):
    """What a message makes of the values that are shown; None if it is refused, which may leave anything in its own part."""
    names, joints, raw = ([*seen[each]] for each in ("names", "joints", "raw"))
    joints[4] = "neck"
    if wire == "head":
        names[2], joints[5] = values["name"] + "!", str(values["count"])
        return {"names": names, "joints": joints, "raw": raw}
    side = WIRES.index(wire)
    is_spared = wire == "right" and values["fault"] != 0
    if values["fault"] > 1 or (len(values["joints"]) < 2 and not is_spared):
        return None
    names[side], raw[side] = values["name"], values["raw"]
    joints[2 * side : 2 * side + 2] = ["none"] * 2 if is_spared else values["joints"]
    return {"names": names, "joints": joints, "raw": raw}


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter", "numba"])
@settings(max_examples=15, deadline=None)
@given(ARRIVALS)
def test_each_message_sets_its_own_texts(backend, arrivals):
    programs, broken = decoders(backend), set()
    holder, seen = programs.new(), {"names": [""] * 3, "joints": [""] * 6, "raw": [b""] * 2}
    for wire, values in arrivals:
        found = taken(wire, values, seen)
        if found is None:
            with pytest.raises(rj.DecodeError):
                programs[wire].into(message(wire, values), holder)
            broken.add(wire)
            continue
        programs[wire].into(message(wire, values), holder)
        broken.discard(wire)
        seen = found
        if not broken:
            assert holder.to_dict() == seen


def test_texts_of_others_stay_where_a_message_is_refused():
    programs = decoders("llvm")
    holder = programs.new()
    for number in range(40):
        arm = {"name": "n" * (7 * number % 50), "joints": ["a" * number, "b"], "raw": b"r" * number, "fault": 0}
        programs.right.into(message("right", arm), holder)
        for _ in range(3):
            with pytest.raises(rj.DecodeError):
                programs.left.into(message("left", {**arm, "joints": ["x" * 20 * number], "raw": b"x" * 200}), holder)
        programs.head.into(message("head", {"name": "h" * number, "count": number}), holder)
        programs.left.into(message("left", {**arm, "name": "left"}), holder)
        assert holder.names == ["left", arm["name"], "h" * number + "!"]
        assert holder.joints == [*arm["joints"], *arm["joints"], "neck", str(number)]
        assert holder.raw == [arm["raw"], arm["raw"]]


def test_lanes_do_not_grow_with_the_number_of_messages():
    programs = decoders("llvm")
    holder = programs.new()
    for number in range(300):
        arm = {"name": "n" * (number % 40), "joints": ["a" * (number % 7), "b"], "raw": b"r" * (number % 11), "fault": 0}
        programs.left.into(message("left", arm), holder)
        programs.right.into(message("right", arm), holder)
    lanes = holder.lanes_
    assert sum(len(lanes.memory[lane]) for lane in range(len(lanes.plan.strides))) < 4096


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter", "numba"])
def test_an_array_of_fixed_length(backend):
    programs = rj.Decoders("fixed.mapping", schema=FILES, backend=backend)
    arm = {"name": "arm", "joints": [], "raw": b"", "fault": 0}
    assert programs.right(message("right", arm)).names == ["arm", "", ""]
    assert programs.head(message("head", {"name": "head of all", "count": 0})).names == ["arm", "", "head of all"]
    assert programs.left(message("left", {**arm, "name": "other arm"})).names == ["arm", "other arm", "head of all"]
    assert programs.right(message("right", {**arm, "name": ""})).names == ["", "other arm", "head of all"]


def test_what_a_program_sets_stays():
    programs = decoders("llvm")
    holder = programs.new()
    programs.right.into(message("right", {"name": "right", "joints": ["a", "b"], "raw": b"", "fault": 0}), holder)
    holder.names[2] = "set by hand"
    holder.joints[0] = "long " * 50
    programs.right.into(message("right", {"name": "r", "joints": ["c", "d"], "raw": b"1", "fault": 0}), holder)
    assert holder.names == ["", "r", "set by hand"]
    assert holder.joints == ["long " * 50, "", "c", "d", "neck", ""]
